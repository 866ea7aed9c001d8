#pragma once
#include <Eigen/Core>
#include <vector>

namespace robomill::cutting::detail {

/// A force record cut into revolutions.

/// Root mean square of a record about its mean in each whole revolution, all components together.
/// @param samples  of a revolution, >= 1, whole or not
[[nodiscard]] std::vector<double> variation_by_revolution(const Eigen::Matrix3Xd& force_n, double samples);

/// Revolutions [begin, end).
struct Run {
  int begin = 0, end = 0;
  [[nodiscard]] int length() const { return end - begin; }
};

/// The one threshold of all that counts revolutions: of a cut, of air, of a level.
inline constexpr int least_revolutions = 5;

/// The variation that `least_revolutions` in succession reach: a shorter jolt is not it, nor is what fills little of
/// the record lost. 0: there are fewer.
[[nodiscard]] double strongest(const std::vector<double>& variation, Run within);

/// What is cut and what is air, by the share of the strongest.
struct CutAndAir {
  double strong = 0.0;
  Run cut;  ///< the longest run above half of it and below twice, without its first and last revolution where the
            ///< record goes on
  std::vector<int> air;  ///< revolutions below a tenth of it
  int weak = 0;          ///< in the longest run that is neither: from a tenth to half of it
  int jolts = 0;         ///< above twice of it
};
/// @param within  where the strongest is sought
[[nodiscard]] CutAndAir find_cut(const std::vector<double>& variation, Run within);

/// The speed in turns a sample that maximises the energy of the first harmonics over a stretch.
/// @param turns      as given
/// @param tolerance  relative, below 0.5 / N of N teeth: 1 / N beside a speed the tooth passing turns by a whole period
/// a
///                   revolution, and looks like that of N - 1 or N + 1 teeth
/// @param harmonics  >= 1, below samples / 2
[[nodiscard]] double find_speed(const Eigen::Matrix3Xd& force_n, double turns, double tolerance, int harmonics);

/// Revolutions at even angles: value i of revolution b is at turn b + i/steps of the record, by a cubic through four
/// samples.
/// @param first  place of turn 0, in samples; at least 1
/// @return one 3 x steps matrix a revolution, as many as the samples hold
[[nodiscard]] std::vector<Eigen::Matrix3Xd> revolutions_at(const Eigen::Matrix3Xd& force_n, double first, double turns,
                                                           Eigen::Index steps);

/// Angles of single revolutions against their mean, and the straight line through them.
struct Angles {
  double slope_rad = 0.0, slope_deviation_rad = 0.0;  ///< a revolution
  double scatter_rad = 0.0;                           ///< standard deviation about the line
};
[[nodiscard]] Angles angles_of(const std::vector<Eigen::Matrix3Xd>& revolutions);

[[nodiscard]] Eigen::Matrix3Xd mean_of(const std::vector<Eigen::Matrix3Xd>& revolutions);

/// The value of largest magnitude in each row, with its sign.
[[nodiscard]] Eigen::Vector3d peaks_of(const Eigen::Matrix3Xd& force_n);

}  // namespace robomill::cutting::detail
