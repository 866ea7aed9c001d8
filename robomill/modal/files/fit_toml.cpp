#include "robomill/modal/files/fit_toml.hpp"

#include <algorithm>
#include <iterator>

#include "robomill/io/toml/file.hpp"
#include "robomill/modal/files/hits_schema.hpp"

namespace robomill::modal {

FitOptions read_fit_options(const io::TomlSource& source, std::vector<std::string>& notes) {
  io::TomlFile file(source);
  FitOptions o;
  fit_options_table().read(file, "fit", o);
  std::ranges::move(file.done(), std::back_inserter(notes));
  file.locate([&] { o.validate(); });
  return o;
}

}  // namespace robomill::modal
