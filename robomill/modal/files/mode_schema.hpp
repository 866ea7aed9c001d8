#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "robomill/io/schema.hpp"
#include "robomill/modal/mode_id.hpp"

namespace robomill::modal {

/// "mode", its number, and "mode_of", "tool" or "workpiece"; both null where it is unknown.
template <class T>
[[nodiscard]] std::vector<io::Row<T>> mode_keys(const std::string& meaning, ModeId T::*member = &T::mode) {
  return {io::key(
              "mode",
              [member](const T& object) {
                const ModeId& mode = object.*member;
                return mode.known() ? std::optional(mode.number) : std::nullopt;
              },
              meaning + ", from 1")
              .nullable(),
          io::key(
              "mode_of",
              [member](const T& object) {
                const ModeId& mode = object.*member;
                return mode.known() ? to_string(mode.of) : std::string_view();
              },
              "structure whose mode it is")
              .words({"tool", "workpiece"})
              .nullable()};
}

}  // namespace robomill::modal
