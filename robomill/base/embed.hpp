#pragma once

// The assembler reads the file into read-only data; the compiler never sees its content. At file scope, once a symbol:
// extern "C" { ROBOMILL_EMBED(name, FILE); extern const char name_begin[]; extern const char name_end[]; }
// FILE is a string literal; a zero follows the content.
#define ROBOMILL_EMBED(symbol, file)        \
  __asm__(                                  \
      ".section .rodata\n"                  \
      ".global " #symbol                    \
      "_begin\n"                            \
      ".hidden " #symbol "_begin\n" #symbol \
      "_begin:\n"                           \
      ".incbin \"" file                     \
      "\"\n"                                \
      ".global " #symbol                    \
      "_end\n"                              \
      ".hidden " #symbol "_end\n" #symbol   \
      "_end:\n"                             \
      ".byte 0\n"                           \
      ".previous\n")
