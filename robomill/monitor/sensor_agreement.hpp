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
/// with its score, up to 1. Votes count together where their lines are one, or differ by a multiple of rotation; those
/// of the line that has most count. The score is these to what an alarm takes:
///   MonitorOptions::agreeing_sensors, or (n + 1)/2,
/// n sensors vote or have seen the cut within 3 s (where none has, all of them). The alarm stays while one that voted
/// for it, or has joined it at its line, detects chatter.
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
    bool usable = false, holds = false;  // the alarm
    double unseen_s = never_s;           // since it saw the cut
    [[nodiscard]] double vote() const noexcept;
    [[nodiscard]] bool sees_the_cut() const noexcept {
      return (decision.faults & speed_unknown) == 0 && decision.reason != BlindReason::standstill;
    }
    [[nodiscard]] bool chatters() const noexcept { return usable && decision.state == State::chatter; }
    [[nodiscard]] bool saw_the_cut() const noexcept { return unseen_s < seen_for_s; }
  };
  void judge(Sensor& sensor, const Hop& hop) noexcept;
  [[nodiscard]] const Sensor& leading() const noexcept;
  [[nodiscard]] bool at_one_line(const Sensor& a, const Sensor& b) const noexcept;
  [[nodiscard]] double votes(const Sensor& leader) const noexcept;
  [[nodiscard]] double enough() const noexcept;
  void hold(const Sensor& leader, double agreement) noexcept;
  void report_speed(Decision& decision) const noexcept;
  [[nodiscard]] BlindReason reason() const noexcept;

  double hop_s_, window_hz_;
  int agreeing_;  // MonitorOptions::agreeing_sensors
  std::vector<Sensor> sensors_;
  bool chatter_ = false;
};

}  // namespace robomill::monitor
