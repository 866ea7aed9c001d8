#include "robomill/formats/joint_programs.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/formats/joint_dialects.hpp"
#include "robomill/formats/trajectory_parts.hpp"
#include "robomill/formats/units.hpp"

namespace robomill::formats {
namespace {

constexpr double usual_period_s = 0.020;
constexpr double standing = 1e-9;          // rad; less than any of these languages can tell apart
constexpr double servoj_period_s = 0.002;  // the 500 Hz of an e-Series controller

/// Of a name, in the language's rules; none: without a limit.
std::optional<std::size_t> longest_name(JointLanguage language) {
  if (language == JointLanguage::krl) return 24;
  if (language == JointLanguage::rapid) return 32;
  return std::nullopt;
}

/// A name that all controllers take: letters, digits and underscores, a letter first. A longer one than the controller
/// takes is not cut off: two programs would be one to it.
std::string name_of(const std::filesystem::path& path, JointLanguage language) {
  std::string name;
  for (const char letter : path.stem().string()) {
    const bool plain = std::isalnum(static_cast<unsigned char>(letter)) != 0;
    name += plain ? letter : '_';
  }
  if (name.empty() || std::isalpha(static_cast<unsigned char>(name.front())) == 0) name = 'p' + name;
  const std::optional<std::size_t> longest = longest_name(language);
  if (longest && name.size() > *longest) {
    throw InvalidInput(path.string(),
                       fmt::format("names its program {}, {} characters; {} takes at most {}", name, name.size(),
                                   language == JointLanguage::krl ? "KRL" : "RAPID", *longest),
                       "Give the file a shorter name");
  }
  return name;
}

std::string one_line(std::string text) {
  for (char& letter : text) {
    if (std::iscntrl(static_cast<unsigned char>(letter)) != 0) letter = ' ';
  }
  return text;
}

std::unique_ptr<JointDialect> dialect_of(JointLanguage language, const std::string& name, double period_s) {
  switch (language) {
    case JointLanguage::krl:
      return krl_dialect(name);
    case JointLanguage::rapid:
      return rapid_dialect(name);
    case JointLanguage::urscript:
      return urscript_dialect(name, period_s);
    case JointLanguage::servoj:
      break;
  }
  return servoj_dialect(period_s);
}

/// Samples from point to point.
std::size_t stride_of(const TrajectoryInfo& info, JointLanguage language) {
  const bool servo = language == JointLanguage::urscript || language == JointLanguage::servoj;
  const double usual = servo ? servoj_period_s : usual_period_s;
  const double wished = info.program_period_s > 0.0 ? info.program_period_s : usual;
  if (!(wished <= 10.0)) throw InvalidInput("program_period_s", wished, "s", "must be at most 10 s");
  const double ratio = wished / info.sample_period_s;
  const double whole = std::max(1.0, std::round(ratio));
  if (info.program_period_s > 0.0 && std::abs(ratio - whole) > 1e-6 * whole) {
    throw InvalidInput("program_period_s", wished, "s", "must be a multiple of the sample period");
  }
  return static_cast<std::size_t>(whole);
}

class JointProgram final : public SampleFile {
 public:
  JointProgram(const std::filesystem::path& path, const TrajectoryInfo& info, JointLanguage language)
      : info_(info),
        language_(language),
        name_(name_of(path, language)),
        stride_(stride_of(info, language)),
        text_(path) {
    between_.reserve(stride_);
    begin();
  }

  void restart() override {
    text_.restart();
    begin();
  }

  void add(std::span<const path::Sample> samples) override {
    for (const path::Sample& sample : samples) {
      between_.push_back(sample);
      if (++count_ % stride_ == 1 || stride_ == 1) keep();
    }
  }

  void commit() override {
    if (!between_.empty()) keep();
    if (point_ && moved_) dialect_->point(text_.buffer(), point_->joints, step_s_, true);
    if (waited_s_ > 0.0) dialect_->wait(text_.buffer(), point_->joints, waited_s_);
    dialect_->close(text_.buffer());
    fill(duration_, fmt::format("{:.6f} s", point_ ? point_->time_s : 0.0));
    fill(apart_,
         fmt::format("{:.6f} degrees a joint, {:.6f} mm at the tip", worst_rad_ / units::deg, worst_m_ / units::mm));
    text_.commit();
  }

 private:
  void begin() {
    dialect_ = dialect_of(language_, name_, period_s());
    between_.clear();
    point_.reset();
    count_ = 0;
    moved_ = false;
    step_s_ = waited_s_ = worst_rad_ = worst_m_ = 0.0;
    dialect_->open(text_.buffer());
    comment(fmt::format("cell {}, program {}", one_line(info_.cell), one_line(info_.program)));
    duration_ = later("duration ", 24);
    comment(fmt::format("a point every {:.6g} ms", period_s() / units::ms));
    apart_ = later("a straight line between two points leaves the trajectory by ", 64);
    std::string advice = dialect_->advice();
    for (std::size_t from = 0; from < advice.size();) {
      const std::size_t to = std::min(advice.find('\n', from), advice.size());
      comment(advice.substr(from, to - from));
      from = to + 1;
    }
  }

  [[nodiscard]] double period_s() const { return static_cast<double>(stride_) * info_.sample_period_s; }

  void comment(const std::string& line) {
    fmt::format_to(fmt::appender(text_.buffer()), "{}{}\n", dialect_->comment(), line);
  }

  Later later(const char* label, std::size_t width) {
    fmt::format_to(fmt::appender(text_.buffer()), "{}{}", dialect_->comment(), label);
    const Later place{.at = text_.size(), .width = width};
    fmt::format_to(fmt::appender(text_.buffer()), "{:{}}\n", "", width);
    return place;
  }

  void fill(const Later& place, std::string value) {
    value.resize(place.width, ' ');
    text_.patch(place.at, value);
  }

  /// Makes the last sample a point. The one before is written now that it is known whether the robot rests there.
  void keep() {
    const path::Sample next = between_.back();
    if (!point_) {
      dialect_->start(text_.buffer(), next.joints);
    } else {
      measure(next);
      const bool still = std::ranges::all_of(between_, [&](const path::Sample& sample) {
        return (sample.joints - point_->joints).cwiseAbs().maxCoeff() < standing;
      });
      const double seconds = next.time_s - point_->time_s;
      if (moved_) dialect_->point(text_.buffer(), point_->joints, step_s_, still);
      if (still) {
        waited_s_ += seconds;
      } else if (waited_s_ > 0.0) {
        dialect_->wait(text_.buffer(), point_->joints, std::exchange(waited_s_, 0.0));
      }
      moved_ = !still;
      step_s_ = seconds;
    }
    point_ = next;
    between_.clear();
    text_.drain();
  }

  /// How far the samples between two points are from the straight line in the joints, and their tips from that in
  /// space.
  void measure(const path::Sample& next) {
    const double span_s = next.time_s - point_->time_s;
    for (const path::Sample& sample : between_) {
      const double share = (sample.time_s - point_->time_s) / span_s;
      const robot::Position6 line = point_->joints + share * (next.joints - point_->joints);
      worst_rad_ = std::max(worst_rad_, (sample.joints - line).cwiseAbs().maxCoeff());
      const Eigen::Vector3d tip = point_->tip_m + share * (next.tip_m - point_->tip_m);
      worst_m_ = std::max(worst_m_, (sample.tip_m - tip).norm());
    }
  }

  TrajectoryInfo info_;
  JointLanguage language_;
  std::string name_;
  std::size_t stride_;
  PendingText text_;
  std::unique_ptr<JointDialect> dialect_;
  std::vector<path::Sample> between_;  ///< since the last point
  std::optional<path::Sample> point_;  ///< the last one, written but for its manner where moved_
  std::size_t count_ = 0;
  bool moved_ = false;     ///< whether the robot moved to the last point
  double step_s_ = 0.0;    ///< … in this time
  double waited_s_ = 0.0;  ///< at the last point
  double worst_rad_ = 0.0, worst_m_ = 0.0;
  Later duration_, apart_;
};

}  // namespace

std::unique_ptr<SampleFile> open_joint_program(const std::filesystem::path& path, const TrajectoryInfo& info,
                                               JointLanguage language) {
  if (info.joints != 6 || std::ranges::count(info.slides, true) > 0) {
    throw InvalidInput(path.string(), "is a program of an arm with six joints that turn; this machine is none",
                       "Write .csv or .h5");
  }
  return std::make_unique<JointProgram>(path, info, language);
}

}  // namespace robomill::formats
