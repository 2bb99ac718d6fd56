/* SPDX-License-Identifier: Apache-2.0 */
/* A library that is no plug-in. */
__attribute__((visibility("default"))) extern const int nothing;
const int nothing = 0;
