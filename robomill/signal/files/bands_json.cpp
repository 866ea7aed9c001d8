#include "robomill/signal/files/bands_json.hpp"

namespace robomill::signal {

const io::Schema<BandView>& band_table() {
  const auto values = [](Eigen::VectorXd Band::*side) {
    return [side](const BandView& view) { return Eigen::VectorXd((view.band->*side) / view.unit); };
  };
  static const io::Schema<BandView> table("band", "lowest and highest value of each run of time",
                                          {io::key("low", values(&Band::low), "none: no value").exact().nullable(),
                                           io::key("high", values(&Band::high), "none: no value").exact().nullable()},
                                          io::Use::written);
  return table;
}

}  // namespace robomill::signal
