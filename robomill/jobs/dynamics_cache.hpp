#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <list>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "robomill/base/assumption.hpp"
#include "robomill/base/progress.hpp"
#include "robomill/jobs/files/lobes_toml.hpp"
#include "robomill/jobs/plan.hpp"

namespace robomill::jobs {

/// The structures that lobes.toml files name. A posture's modes take seconds to find, and somebody who moves a slider
/// asks for the same ones again and again.
class DynamicsCache {
 public:
  /// @param most  structures that are kept; the one that was asked for longest ago goes first
  explicit DynamicsCache(std::size_t most = 8) : most_(most) {}
  /// As load_dynamics, but that a default for [uncertainty] is left to the caller. Files are read again when one
  /// of them, or what the document says of the structure, has changed.
  void load(LobesFile& file, Progress& progress);

  /// As take_plan, with the structure of a job. It is found again when one of the files that the job names
  /// changes.
  void load_plan(LobesFile& file, const std::filesystem::path& job, Progress& progress);

  /// How often files were read.
  [[nodiscard]] std::size_t reads() const { return reads_; }

 private:
  /// What a structure depends on.
  struct Key {
    std::vector<std::filesystem::path> files = {};  ///< the document, then those that it names
    std::vector<double> joints = {};
    cell::PostureAxes axes = cell::PostureAxes::base;
    bool equal = false;
    std::vector<modal::Axis> rigid = {};
    bool in_three_directions = false, drilling = false;
    bool operator==(const Key&) const = default;
  };
  /// A file's size and time of modification; 0, 0 where it is not there.
  using Stamp = std::pair<std::uintmax_t, std::filesystem::file_time_type>;
  struct Structure {
    Key key;
    std::vector<std::filesystem::path> watched = {};  ///< files, also those that a cell names
    std::vector<Stamp> stamps = {};
    modal::ModalModel dynamics = {}, workpiece_dynamics = {};
    modal::FrfSet measured = {}, workpiece_measured = {};
    std::shared_ptr<const cell::ModesOfPosture> posture = {};
    std::vector<std::string> notes = {};
    std::vector<Assumption> assumed = {};
  };
  struct Planned {
    std::filesystem::path job = {};
    std::vector<std::filesystem::path> watched = {};
    std::vector<Stamp> stamps = {};
    std::shared_ptr<const PlanResult> structure = {};
  };
  void read(LobesFile& file, Progress& progress);
  static Key key_of(const LobesFile& file);
  static std::vector<std::filesystem::path> watched_files(const LobesFile& file);
  static std::vector<Stamp> stamps_of(const std::vector<std::filesystem::path>& files);

  std::size_t most_, reads_ = 0;
  std::list<Structure> kept_;   ///< the one that was asked for last stands first
  std::list<Planned> planned_;  ///< the same of jobs
};

}  // namespace robomill::jobs
