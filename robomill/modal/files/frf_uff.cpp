#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <numbers>

#include "robomill/base/error.hpp"
#include "robomill/io/file.hpp"
#include "robomill/io/records/uff.hpp"
#include "robomill/io/si.hpp"
#include "robomill/io/text.hpp"
#include "robomill/modal/files/frf_files.hpp"
#include "robomill/modal/files/frf_parts.hpp"

namespace robomill::modal {
namespace {

constexpr int type_general = 0;
constexpr int type_frf = 4;
constexpr int type_coherence = 6;
constexpr int axis_displacement = 8;
constexpr int axis_force = 13;
constexpr int axis_frequency = 18;

/// No function type of the format means it: a general function with this description in its fourth line.
constexpr const char* standard_deviation = "robomill: standard deviation";

bool is_angular(int direction) {
  return std::abs(direction) > 3;
}

std::optional<FrfName> name_of(const io::UffFunction& function) {
  const auto known = [](int direction) { return direction != 0 && std::abs(direction) <= 6; };
  if (!known(function.response_direction) || !known(function.reference_direction)) return std::nullopt;
  const auto dof = [](int node, int direction) {
    return Dof{.point = std::max(node, 0), .axis = static_cast<Axis>(std::abs(direction))};
  };
  return FrfName{.response = dof(function.response_node, function.response_direction),
                 .excitation = dof(function.reference_node, function.reference_direction)};
}

bool same_place(const io::UffFunction& a, const io::UffFunction& b) {
  return a.response_node == b.response_node && a.reference_node == b.reference_node &&
         std::abs(a.response_direction) == std::abs(b.response_direction) &&
         std::abs(a.reference_direction) == std::abs(b.reference_direction);
}

bool is_deviation(const io::UffFunction& function) {
  return function.type == type_general && function.id[3] == standard_deviation;
}

class UffFrfs {
 public:
  explicit UffFrfs(const std::filesystem::path& path) : file_(io::parse_uff(io::read_file(path), path.string())) {
    out_.file = path;
    out_.notes = file_.notes;
  }

  FrfParts read() {
    for (const io::UffFunction& function : file_.functions) {
      if (function.type == type_frf) {
        check_axis(function);
        out_.frfs.push_back(read_frf(function));
        from_.push_back(&function);
      } else if (function.type != type_coherence && !is_deviation(function)) {
        note(function, fmt::format("function type {} is no FRF and left out", function.type));
      }
    }
    if (out_.frfs.empty()) {
      throw InvalidInput(out_.file.string(), "holds no frequency response function (data set 58, function type 4)",
                         "Time responses become FRFs with robomill frf");
    }
    for (const io::UffFunction& function : file_.functions) {
      if (function.type == type_coherence || is_deviation(function)) attach(function);
    }
    return std::move(out_);
  }

 private:
  [[nodiscard]] std::string where(const io::UffFunction& function) const {
    const std::optional<FrfName> name = name_of(function);
    const std::string title = name ? fmt::format(" ({})", to_string(*name)) : "";
    return fmt::format("{}:{}{}", out_.file.string(), function.line, title);
  }
  void note(const io::UffFunction& function, const std::string& text) {
    out_.notes.push_back(fmt::format("{}: {}", where(function), text));
  }

  static Eigen::VectorXd frequencies(const io::UffFunction& function) {
    const bool angular = io::lowered(function.abscissa_axis.unit) == "rad/s";
    return angular ? Eigen::VectorXd(function.abscissa / (2.0 * std::numbers::pi)) : function.abscissa;
  }

  void check_axis(const io::UffFunction& function) {
    const Eigen::VectorXd frequency_hz = frequencies(function);
    if (out_.frfs.empty()) out_.frequency_hz = frequency_hz;
    const Eigen::VectorXd& first = out_.frequency_hz;
    const double tolerance = 1e-5 * first.cwiseAbs().maxCoeff();
    if (frequency_hz.size() != first.size() || (frequency_hz - first).cwiseAbs().maxCoeff() > tolerance) {
      throw InvalidInput(where(function), "has other frequencies than the FRF before it",
                         "FRFs that go together need one axis");
    }
  }

  FrfPart read_frf(const io::UffFunction& function) {
    FrfPart part{.name = name_of(function), .values = function.values};
    const double length = is_angular(function.response_direction) ? 1.0 : function.length_factor;
    io::SiFactor response = io::si_factor(function.numerator, length, function.force_factor);
    io::UffAxis force_axis = function.denominator;
    if (is_angular(function.reference_direction) && force_axis.length_exponent == 0 && force_axis.force_exponent == 0) {
      force_axis.length_exponent = force_axis.force_exponent = 1;
    }
    io::SiFactor force = io::si_factor(force_axis, function.length_factor, function.force_factor);
    if (response.is_ratio) force = io::SiFactor{};
    for (const io::SiFactor* factor : {&response, &force}) {
      if (!factor->note.empty()) note(function, factor->note);
    }
    if (response.quantity == io::Quantity::force ||
        (force.quantity != io::Quantity::force && force.quantity != io::Quantity::unknown)) {
      throw InvalidInput(where(function), "is no displacement, velocity or acceleration per force",
                         "Dynamic stiffnesses and transmissibilities are not read");
    }
    if (response.quantity == io::Quantity::unknown) {
      add_assumed(out_.assumed, {{.what = "Quantity of FRFs",
                                  .taken = "receptances in m/N",
                                  .key = "units of data set 58",
                                  .file = out_.file.filename().string()}});
      part.stated = false;
    } else {
      part.derivatives = static_cast<int>(response.quantity);
    }
    part.values *= sign(function) * response.factor / force.factor;
    return part;
  }

  static double sign(const io::UffFunction& function) {
    return (function.response_direction < 0 ? -1.0 : 1.0) * (function.reference_direction < 0 ? -1.0 : 1.0);
  }

  void attach(const io::UffFunction& function) {
    const auto owner =
        std::find_if(from_.begin(), from_.end(), [&](const io::UffFunction* f) { return same_place(*f, function); });
    const bool fits = function.values.size() == out_.frequency_hz.size();
    if (owner == from_.end() || !fits) {
      note(function, fmt::format("function type {} belongs to no FRF here and is left out", function.type));
      return;
    }
    FrfPart& part = out_.frfs[static_cast<std::size_t>(owner - from_.begin())];
    (is_deviation(function) ? part.deviation : part.coherence) = function.values.real();
  }

  io::UffFile file_;
  FrfParts out_;
  std::vector<const io::UffFunction*> from_;  ///< what each FRF was read from
};

io::UffFunction describe(const FrfName& name, int type, const FrfSet& set) {
  io::UffFunction out;
  out.type = type;
  out.id[0] = to_string(name);
  out.response_node = name.response.point;
  out.response_direction = static_cast<int>(name.response.axis);
  out.reference_node = name.excitation.point;
  out.reference_direction = static_cast<int>(name.excitation.axis);
  out.abscissa = set.frequency_hz;
  out.abscissa_axis = {.type = axis_frequency, .label = "Frequency", .unit = "Hz"};
  return out;
}

void name_receptance_axes(io::UffFunction& function) {
  const bool rotation = is_angular(function.response_direction), moment = is_angular(function.reference_direction);
  function.numerator = {.type = axis_displacement,
                        .length_exponent = rotation ? 0 : 1,
                        .label = rotation ? "Rotation" : "Displacement",
                        .unit = rotation ? "rad" : "m"};
  function.denominator = {.type = axis_force,
                          .length_exponent = moment ? 1 : 0,
                          .force_exponent = 1,
                          .label = moment ? "Moment" : "Force",
                          .unit = moment ? "N m" : "N"};
}

}  // namespace

FrfParts read_frf_uff(const std::filesystem::path& path) {
  return UffFrfs(path).read();
}

std::string frf_uff(const FrfSet& set, bool binary) {
  std::vector<io::UffFunction> functions;
  for (const Frf& frf : set.frfs) {
    io::UffFunction function = describe(frf.name, type_frf, set);
    name_receptance_axes(function);
    function.is_complex = true;
    function.values = frf.receptance;
    functions.push_back(std::move(function));
    if (frf.coherence.size() > 0) {
      io::UffFunction coherence = describe(frf.name, type_coherence, set);
      coherence.values = frf.coherence.cast<std::complex<double>>();
      functions.push_back(std::move(coherence));
    }
    if (frf.deviation.size() > 0) {
      io::UffFunction deviation = describe(frf.name, type_general, set);
      name_receptance_axes(deviation);
      deviation.id[3] = standard_deviation;
      deviation.values = frf.deviation.cast<std::complex<double>>();
      functions.push_back(std::move(deviation));
    }
  }
  return io::format_uff(functions, binary);
}

}  // namespace robomill::modal
