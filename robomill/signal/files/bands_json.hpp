#pragma once
#include <string>

#include "robomill/io/schema.hpp"
#include "robomill/signal/bands.hpp"

namespace robomill::signal {

/// A band in a shop unit.
struct BandView {
  const Band* band = nullptr;
  double unit = 1.0;
};
[[nodiscard]] const io::Schema<BandView>& band_table();

/// A key that holds a band in the unit of its name.
template <class T>
[[nodiscard]] io::Row<T> band_key(const std::string& name, Band T::*member, const std::string& meaning) {
  const double unit = io::key_unit(name).factor;
  return io::key(
      name,
      [member, unit](const T& object) {
        return BandView{&(object.*member), unit};
      },
      band_table(), meaning);
}

}  // namespace robomill::signal
