#include "robomill/cell/files/known_arms.hpp"

#include <array>
#include <cctype>
#include <cstddef>
#include <utility>

#include "robomill/base/embed.hpp"
#include "robomill/io/text.hpp"
#include "robomill/io/toml/file.hpp"
#include "robomill/path/files/trajectory.hpp"

// By their names.
// clang-format off
#define ROBOMILL_ARMS(each)                 \
  each(abb_irb4600, "abb-irb4600-60-205")   \
  each(abb_irb6640, "abb-irb6640-185-280")  \
  each(fanuc_m20ia, "fanuc-m20ia")          \
  each(fanuc_r2000ic, "fanuc-r2000ic-165f") \
  each(kuka_kr120, "kuka-kr120-r2500")      \
  each(kuka_kr210, "kuka-kr210-r2700")      \
  each(staubli_rx160, "staubli-rx160")      \
  each(staubli_tx2_90, "staubli-tx2-90")    \
  each(ur_10e, "ur-10e")                    \
  each(ur_5e, "ur-5e")                      \
  each(yaskawa_gp25, "yaskawa-gp25")
// clang-format on

#define ROBOMILL_EMBED_CELL(symbol, name)                                  \
  ROBOMILL_EMBED(robomill_cell_##symbol, ROBOMILL_CELLS "/" name ".toml"); \
  extern const char robomill_cell_##symbol##_begin[];                      \
  extern const char robomill_cell_##symbol##_end[];
#define ROBOMILL_CELL(symbol, name) EmbeddedCell{name, robomill_cell_##symbol##_begin, robomill_cell_##symbol##_end},

extern "C" {
ROBOMILL_ARMS(ROBOMILL_EMBED_CELL)
}

namespace robomill::cell {
namespace {

struct EmbeddedCell {
  std::string_view name;
  const char *begin, *end;
  [[nodiscard]] std::string_view text() const { return {begin, static_cast<std::size_t>(end - begin)}; }
};

const auto& embedded_cells() {
  static const std::array cells = {ROBOMILL_ARMS(ROBOMILL_CELL)};
  return cells;
}

}  // namespace

std::string maker_of(std::string_view name) {
  // A maker's name, or a series that only one maker has, at the beginning of a word.
  static constexpr std::array<std::pair<std::string_view, const char*>, 19> words = {
      {{"kuka", path::maker_kuka},
       {"lbr", path::maker_kuka},
       {"kr", path::maker_kuka},
       {"abb", path::maker_abb},
       {"irb", path::maker_abb},
       {"universal", path::maker_universal_robots},
       {"ur", path::maker_universal_robots},
       {"fanuc", "FANUC"},
       {"crx", "FANUC"},
       {"staubli", "Stäubli"},
       {"stäubli", "Stäubli"},
       {"yaskawa", "Yaskawa"},
       {"motoman", "Yaskawa"},
       {"gp", "Yaskawa"},
       {"comau", "Comau"},
       {"kawasaki", "Kawasaki"},
       {"nachi", "Nachi"},
       {"mitsubishi", "Mitsubishi"},
       {"denso", "Denso"}}};
  const std::string lower = io::lowered(std::string(name));
  const auto letter = [](char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0; };
  for (const auto& [word, maker] : words) {
    for (std::size_t at = lower.find(word); at != std::string::npos; at = lower.find(word, at + 1)) {
      const std::size_t end = at + word.size();
      const bool begins = at == 0 || !letter(lower[at - 1]);
      // A series is followed by its number; a name may end with anything that is no letter.
      const bool series = word.size() <= 3 && word != "abb";
      std::size_t next = end;
      while (series && next < lower.size() && (lower[next] == ' ' || lower[next] == '-' || lower[next] == '_')) ++next;
      const bool ends = series ? next < lower.size() && std::isdigit(static_cast<unsigned char>(lower[next])) != 0
                               : end == lower.size() || !letter(lower[end]);
      if (begins && ends) return maker;
    }
  }
  return {};
}

std::vector<KnownArm> known_arms() {
  std::vector<KnownArm> arms;
  for (const EmbeddedCell& cell : embedded_cells()) {
    KnownArm& arm = arms.emplace_back();
    arm.name = cell.name;
    io::TomlFile(io::TomlSource(arm.name, std::string(cell.text()))).text("robot.description", arm.description);
  }
  return arms;
}

std::string_view known_arm_cell(std::string_view name) {
  for (const EmbeddedCell& cell : embedded_cells()) {
    if (cell.name == name) return cell.text();
  }
  return {};
}

}  // namespace robomill::cell
