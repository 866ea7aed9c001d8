#pragma once
#include <pybind11/pybind11.h>

#include <atomic>
#include <csignal>
#include <exception>
#include <functional>
#include <string>
#include <utility>

#include "robomill/base/progress.hpp"

// What every call of the library from Python does: without the lock, stopped by Ctrl-C, with progress where it is
// wanted.

namespace robomill::python {

namespace py = pybind11;

/// While it lives, Ctrl-C sets a flag that work looks at, in the place of Python's handler, which would wait for the
/// work's end. In the main thread alone, as in Python.
class StopOnInterrupt {
 public:
  explicit StopOnInterrupt(std::atomic<bool>& stop);
  ~StopOnInterrupt();
  StopOnInterrupt(const StopOnInterrupt&) = delete;
  StopOnInterrupt& operator=(const StopOnInterrupt&) = delete;
  /// Raises KeyboardInterrupt where Ctrl-C was pressed.
  void raise_if_interrupted() const;

 private:
  bool ours_ = false;
  struct sigaction before_ = {};
};

/// Reports to a Python function progress(task, fraction), or to nobody if it is None. An exception of it stops the
/// work.
class PythonProgress {
 public:
  explicit PythonProgress(py::object report);
  [[nodiscard]] Progress& progress() { return progress_; }
  [[nodiscard]] std::atomic<bool>& stop() { return stop_; }
  /// Raises what the function raised.
  void rethrow() const;

 private:
  py::object report_;
  std::atomic<bool> stop_{false};
  std::exception_ptr raised_ = nullptr;
  Progress progress_;
};

/// Work that takes no time worth a report.
template <class Work>
auto without_lock(Work&& work) {
  const py::gil_scoped_release release;
  return std::forward<Work>(work)();
}

/// Work that may take long. @throws KeyboardInterrupt after Ctrl-C
template <class Work>
auto with_progress(const py::object& report, Work&& work) {
  PythonProgress to(report);
  const StopOnInterrupt interruptible(to.stop());
  try {
    const py::gil_scoped_release release;
    return std::forward<Work>(work)(to.progress());
  } catch (const Interrupted&) {
    to.rethrow();
    interruptible.raise_if_interrupted();
    throw;
  }
}

}  // namespace robomill::python
