#pragma once
#include <Eigen/Core>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "robomill/base/assumption.hpp"
#include "robomill/modal/frf.hpp"

namespace robomill::modal {

/// One FRF of a file, which may leave it unnamed.
struct FrfPart {
  std::optional<FrfName> name = {};
  Eigen::VectorXcd values = {};                    ///< receptance, mobility or accelerance in SI
  Eigen::VectorXd coherence = {}, deviation = {};  ///< empty where the file has none; deviation as values
  int derivatives = 0;                             ///< 0 receptance, 1 mobility, 2 accelerance
  bool stated = true;                              ///< the file says what the values are; else they are guessed
};

/// The FRFs of one file over their common axis.
struct FrfParts {
  std::filesystem::path file;
  Eigen::VectorXd frequency_hz = {};
  std::vector<FrfPart> frfs = {};
  std::vector<std::string> notes = {};
  std::vector<Assumption> assumed = {};
  double added_decay_per_s = 0.0;
};

/// Columns frequency_hz, xx_re_m_per_n, xx_im_m_per_n, …, xx_coherence, xx_deviation_m_per_n, in these units or those
/// of a mobility or accelerance, or xx_magnitude_m_per_n and xx_phase_deg or _rad; or three columns with a header in
/// words ("Magnitude (m/N)"); or no names and a frequency, then pairs of real and imaginary parts.
[[nodiscard]] FrfParts read_frf_table(const std::filesystem::path& path);
/// Functions of type 4 with coherences of type 6, in the units that the file says.
[[nodiscard]] FrfParts read_frf_uff(const std::filesystem::path& path);
/// frequency_hz, H_xx, C_xx (coherence), S_xx (deviation); a colon in a name is an underscore: H_1x_3x.
[[nodiscard]] FrfParts read_frf_mat(const std::filesystem::path& path);
/// tip.json
[[nodiscard]] FrfParts read_frf_json(const std::filesystem::path& path);

[[nodiscard]] std::string frf_table(const FrfSet& set, char separator);
void write_frf_mat(const std::filesystem::path& path, const FrfSet& set);

/// The FRF that text names. @throws InvalidInput with where
[[nodiscard]] FrfName frf_name_at(const std::string& where, std::string_view text);

}  // namespace robomill::modal
