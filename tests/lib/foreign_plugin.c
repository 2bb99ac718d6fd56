/* SPDX-License-Identifier: Apache-2.0 */
/* A plug-in of another build. What stands behind the hash must not be read. */
__attribute__((visibility("default"))) const char* const* bitspan_plugin(void);
const char* const* bitspan_plugin(void) {
  static const char* const plugin = "0123456789abcdef";
  return &plugin;
}
