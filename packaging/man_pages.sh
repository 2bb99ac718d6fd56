#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Writes a manual page per command into FOLDER, from what the program's --help says.
#
#   packaging/man_pages.sh HELP2MAN PROGRAM FOLDER
set -eu
help2man=$1 program=$2 folder=$3

# The program goes by its name in what help2man runs and prints.
PATH=$(dirname "$program"):$PATH
export PATH LC_ALL=C
rm -rf "$folder"
mkdir -p "$folder"

commands_of() {
  "$@" --help | sed -n '/^Subcommands:/,/^$/s/^  \([a-z][a-z-]*\) .*/\1/p'
}

# page WORD...: the page of one command and those below it.
page() {
  name=$(echo "$*" | tr ' ' '-')
  "$help2man" --no-info --section=1 --manual=bitspan --source="$version" --version-string="$name ${version#* }" \
    --name="$("$@" --help | head -n 1 | sed 's/^bitspan: //')" --output="$folder/$name.1" "$*"
  sed -i 's/^Exit: /.SH "EXIT STATUS"\n/; /^Example:$/,$ { s/^Example:$/.SH EXAMPLE/; s/^\.IP$/.nf/ }' "$folder/$name.1"
  for command in $(commands_of "$@"); do page "$@" "$command"; done
}
version=$(bitspan --version)
page bitspan
