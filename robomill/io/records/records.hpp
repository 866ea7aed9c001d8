#pragma once
#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "robomill/base/export.hpp"

namespace robomill::io {

/// Columns over time, as recorded.
struct Record {
  std::filesystem::path file;
  double sample_rate_hz = 0.0;                ///< [Hz]; 0 where the file does not say
  bool rate_is_stated = false;                ///< by the header of a text, which nothing else of the file confirms
  double rate_error = 0.0;                    ///< relative, of the digits that the file writes it with
  std::vector<std::string> names;             ///< one a column; empty texts where the file names none
  std::vector<std::string> units = {};        ///< one a column, beside its name; empty texts: not said
  std::string units_by = "the row of units";  ///< where the file says them
  bool si_assumed = false;                    ///< units are SI because the file states none
  std::vector<Eigen::VectorXd> columns;       ///< in the order of the file, a column of time among them
  std::vector<std::string> left_out = {};     ///< what of the file is no column, each with the reason: "Temp (10 Hz)"
  std::vector<std::string> notes = {};        ///< what a reader must know: data sets skipped, units converted

  /// The column of that name, or of that number from 1 where no column has the name.
  /// @throws InvalidInput naming the columns that are there
  [[nodiscard]] const Eigen::VectorXd& column(const std::string& name_or_number) const;
  /// Its place, and its errors.
  [[nodiscard]] std::size_t place(const std::string& name_or_number) const;
  /// Its unit as the row of units says it, else as its name does (io/si.hpp); empty: not said.
  [[nodiscard]] std::string unit(std::size_t place) const;
};

struct RecordOptions {
  /// Column of the time [s], by name or number from 1. Empty: a column named time_s, time or t, where there is one.
  std::string time = {};
  double scale = 1.0;  ///< what full scale means in WAV, in any unit; finite, not 0
  void validate() const;
};

/// Reads a record by its ending, of text without a column of time with the rate that its header states ("sample rate:
/// 25600 Hz", "Delta_X 3.9e-5"): .csv .txt .dat .asc (columns parted by commas, semicolons, tabs or blanks, with or
/// without header; a column whose row of units is one of time is converted to s), .mat (v5, v7.3), .h5 .hdf5 .hdf, .npy
/// .npz, .uff .unv .uf (time responses), .wav, .lvm, .tdms (one channel a column).
/// @throws InvalidInput with file and line if it is missing or empty, a value is no finite number, a line has another
///     number of values than those before it, or the time does not run evenly
[[nodiscard]] Record read_record(const std::filesystem::path& path, const RecordOptions& options = {});

/// The rate of a record for which the user gives one too; 0: neither is known. One that only a header states gives way
/// to the user's, with a note; one that the file writes with too few digits is noted where the user gives none.
/// @param key  what the user gave it as; @param given_hz  0: not given
/// @throws InvalidInput with the record's file where both are known, none is only stated, and they differ
[[nodiscard]] double rate_of(const Record& record, double given_hz, std::string_view key,
                             std::vector<std::string>& notes);

/// Whether a file is one that read_record reads, by its ending.
[[nodiscard]] ROBOMILL_API bool is_read_as_record(const std::filesystem::path& path);
/// The endings of those files: ".csv", ".txt", …
[[nodiscard]] std::vector<std::string_view> record_endings();
/// ".csv, .txt, … and .wav"
[[nodiscard]] std::string record_endings_text();

/// What a file is that holds a record and is not read, and what to do: "an ASAM MDF file, which is not read yet". Empty
/// texts where the ending says nothing of it.
struct UnreadRecord {
  std::string what = {}, remedy = {};
};
[[nodiscard]] UnreadRecord unread_record(const std::filesystem::path& path);

/// The rate of a column of time that never falls and has too few digits for its steps, some of which are therefore 0:
/// that of the straight line through all of it. 0 where the column is none.
[[nodiscard]] double rounded_sample_rate_of(const Eigen::VectorXd& time_s);

/// The rate of evenly rising times. @throws InvalidInput naming `where` if a step is more than half a step off
[[nodiscard]] double sample_rate_of(const Eigen::VectorXd& time_s, const std::string& where);

}  // namespace robomill::io
