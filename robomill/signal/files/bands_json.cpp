#include "robomill/signal/files/bands_json.hpp"

namespace robomill::signal {

io::Json band_json(const Band& band, double unit) {
  return {{"low", io::numbers(band.low / unit)}, {"high", io::numbers(band.high / unit)}};
}

}  // namespace robomill::signal
