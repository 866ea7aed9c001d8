// fit_labels [SEEDS]: cuts of a known machine with the labels of two operators; what modes fitted to the labels, a
// depth threshold and a tap test say of other cuts of that machine.
#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <vector>

#include "examples/labelled-cuts/labelled_cuts.hpp"

namespace {

using namespace robomill::examples;
using robomill::cutting::MillingDirection;

std::string of_seeds(std::vector<double> shares) {
  std::ranges::sort(shares);
  return fmt::format("{:.0f} % ({:.0f} to {:.0f})", 100.0 * shares[shares.size() / 2], 100.0 * shares.front(),
                     100.0 * shares.back());
}

void run(int seeds) {
  struct Kind {
    const char* name;
    CutKind kind;
  };
  const std::vector<Kind> kinds = {{"down, 3 mm, as labelled", {}},
                                   {"down, 6 mm", {.radial_depth_m = 0.006}},
                                   {"down, 1 mm", {.radial_depth_m = 0.001}},
                                   {"up, 3 mm", {.direction = MillingDirection::up}},
                                   {"up, 6 mm", {.direction = MillingDirection::up, .radial_depth_m = 0.006}}};
  std::vector<std::vector<double>> labels(kinds.size()), depth(kinds.size()), tap(kinds.size());
  fmt::print("seed  modes fitted to the labels (Hz)  log likelihood, of the true modes\n");
  for (int seed = 1; seed <= seeds; ++seed) {
    const auto number = static_cast<std::uint64_t>(seed);
    const std::vector<LabelledCut> cuts = label_cuts(number);
    const LabelFit fit = fit_to_labels(cuts, number);
    const double threshold_m = threshold_of(cuts);
    const robomill::modal::ModalModel tapped = tap_test(number);
    fmt::print("{:<6}x {:.0f}, y {:.0f}{:>22.1f}, {:.1f}\n", seed, fit.modes.frequency_hz[0], fit.modes.frequency_hz[1],
               fit.log_likelihood, fit.log_likelihood_of_true);
    for (std::size_t k = 0; k < kinds.size(); ++k) {
      const Question question = ask(kinds[k].kind, number);
      labels[k].push_back(answered(question, kinds[k].kind, fit.modes.model()));
      depth[k].push_back(answered(question, threshold_m));
      tap[k].push_back(answered(question, kinds[k].kind, tapped));
    }
  }
  fmt::print("\n{:<26}{:>26}{:>26}{:>26}\n", "right of 400, near limits", "fitted to the labels", "depth threshold",
             "tap test");
  for (std::size_t k = 0; k < kinds.size(); ++k) {
    fmt::print("{:<26}{:>26}{:>26}{:>26}\n", kinds[k].name, of_seeds(labels[k]), of_seeds(depth[k]), of_seeds(tap[k]));
  }
}

}  // namespace

int main(int argc, char** argv) {
  const int seeds = argc > 1 ? std::atoi(argv[1]) : 7;
  if (argc > 2 || seeds < 1 || seeds > 100) {
    std::fputs("usage: fit_labels [SEEDS, 1 to 100]\n", stderr);
    return 2;
  }
  try {
    run(seeds);
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
