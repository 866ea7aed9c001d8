#pragma once
#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "robomill/monitor/detector.hpp"
#include "robomill/monitor/order_detector.hpp"

namespace robomill::monitor {

/// A sensor of several: its channels among those of the stream, the tachometer last, and the options of a monitor that
/// has it alone.
struct SensorPart {
  std::vector<std::size_t> channels = {};
  MonitorOptions options = {};
};
/// One a sensor; of a stream of one sensor the options as they are.
[[nodiscard]] std::vector<SensorPart> parts_by_sensor(const MonitorOptions& options);

/// Several sensors of one cut: each is judged by a detector of its own, and an alarm takes their agreement. Each votes
/// with its score up to 1, where its line is that of the strongest vote, or differs from it by a multiple of rotation.
/// The score is the votes to those an alarm takes: MonitorOptions::agreeing_sensors, or (n + 1)/2; n sensors have seen
/// the cut within 3 s (where none has, all of them). The alarm stays while a sensor detects chatter.
class SensorAgreement final : public Detector {
 public:
  static constexpr double seen_for_s = 3.0;

  explicit SensorAgreement(const MonitorOptions& options);
  void decide(const Hop& hop, Decision& decision) noexcept override;
  void set_spindle_speed(double rad_per_s) noexcept override;
  void reset() noexcept override;

 private:
  static constexpr double never_s = 1e9;
  struct Sensor {
    explicit Sensor(SensorPart&& part);
    std::vector<std::size_t> channels;
    std::size_t of_vibration;  // of these, the first ones
    std::unique_ptr<OrderDetector> detector;
    std::vector<double> samples;  // of the hop, channel after channel
    Decision decision;
    bool usable = false;
    double unseen_s = never_s;  // since it saw the cut
    [[nodiscard]] double vote() const noexcept;
    [[nodiscard]] bool sees_the_cut() const noexcept { return (decision.faults & speed_unknown) == 0; }
    [[nodiscard]] bool saw_the_cut() const noexcept { return unseen_s < seen_for_s; }
  };
  void judge(Sensor& sensor, const Hop& hop) noexcept;
  [[nodiscard]] const Sensor& leading() const noexcept;
  [[nodiscard]] double votes(const Sensor& leader) const noexcept;
  void report_speed(Decision& decision) const noexcept;
  [[nodiscard]] BlindReason reason() const noexcept;

  double hop_s_, window_hz_;
  int agreeing_;  // 0: more than half
  std::vector<Sensor> sensors_;
  bool chatter_ = false;
};

}  // namespace robomill::monitor
