#pragma once
// For .cpp files inside the library, as json.hpp.
#include <functional>
#include <string>
#include <string_view>
#include <utility>

#include "robomill/io/json.hpp"

namespace robomill::io {

/// An object in the text of dump(), key by key, and a list of objects in it entry by entry: neither is held.
class JsonText {
 public:
  /// Gets the text piece by piece.
  using Take = std::function<void(std::string_view)>;
  explicit JsonText(Take take) : take_(std::move(take)) {}
  void add(std::string_view key, const Json& value);
  /// Begins a list under a key.
  void begin_list(std::string_view key);
  /// An object, or a list, in the list that was begun.
  void add_entry(const Json& entry);
  void end_list();
  /// Ends the object, and the text.
  void end();

 private:
  void begin(std::string_view key);
  Take take_;
  std::string text_;
  bool empty_ = true, empty_list_ = true;
};

}  // namespace robomill::io
