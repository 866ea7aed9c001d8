// make_program OUT.ngc: the example's program, fourteen passes of 140 moves.
#include <cstdio>
#include <string>

#include "examples/smooth-impeller-like/blade.hpp"

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fputs("usage: make_program OUT.ngc\n", stderr);
    return 2;
  }
  const std::string text = robomill::examples::blade_program(14, 140);
  std::FILE* const file = std::fopen(argv[1], "wb");
  if (file == nullptr) {
    std::perror(argv[1]);
    return 1;
  }
  const bool written = std::fwrite(text.data(), 1, text.size(), file) == text.size();
  return std::fclose(file) == 0 && written ? 0 : 1;
}
