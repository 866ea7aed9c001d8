#include "robomill/modal/files/fit_toml.hpp"

#include <algorithm>
#include <iterator>

#include "robomill/base/error.hpp"
#include "robomill/io/toml/file.hpp"

namespace robomill::modal {

FitOptions read_fit_options(const io::TomlSource& source, std::vector<std::string>& notes) {
  io::TomlFile file(source);
  FitOptions o;
  file.choice("fit.method", fit_method_names, o.method);
  file.choice<Weighting>("fit.weighting",
                         {{"automatic", Weighting::automatic},
                          {"none", Weighting::none},
                          {"relative", Weighting::relative},
                          {"coherence", Weighting::coherence},
                          {"deviation", Weighting::deviation},
                          {"estimated", Weighting::estimated}},
                         o.weighting);
  std::vector<double> band;
  if (file.numbers("fit.band_hz", "band_hz", 1.0, band)) {
    if (band.size() != 2 || !(band[0] < band[1]))
      throw file.reject("fit.band_hz", "must be [low, high] with low < high");
    o.band_low_hz = band[0];
    o.band_high_hz = band[1];
  }
  file.integer("fit.modes", "modes", o.modes);
  file.integer("fit.max_modes", "max_modes", o.max_modes);
  file.boolean("fit.residuals", o.residuals);
  file.integer("fit.lscf_max_order", "lscf_max_order", o.lscf_max_order);
  file.integer("fit.pso_particles", "pso_particles", o.pso_particles);
  file.integer("fit.pso_max_iterations", "pso_max_iterations", o.pso_max_iterations);
  const auto number = [&file](const char* name, double& out) {
    file.number("fit." + std::string(name), name, 1.0, out);
  };
  number("max_damping_ratio", o.max_damping_ratio);
  number("exponential_decay_per_s", o.exponential_decay_per_s);
  number("stable_frequency", o.stable_frequency);
  number("stable_damping", o.stable_damping);
  number("stable_mac", o.stable_mac);
  number("pso_frequency_half_width", o.pso_frequency_half_width);
  number("pso_max_damping_ratio", o.pso_max_damping_ratio);
  std::ranges::move(file.done(), std::back_inserter(notes));
  file.locate([&] { o.validate(); });
  return o;
}

}  // namespace robomill::modal
