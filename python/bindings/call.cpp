#include "python/bindings/call.hpp"

#include <exception>

namespace robomill::python {
namespace {

std::atomic<std::atomic<bool>*> stopped_by_interrupt{nullptr};
std::atomic<bool> interrupted{false};
static_assert(std::atomic<bool>::is_always_lock_free && std::atomic<std::atomic<bool>*>::is_always_lock_free,
              "a signal handler writes them");

void on_interrupt(int /*signal*/) {
  interrupted = true;
  if (std::atomic<bool>* const stop = stopped_by_interrupt) *stop = true;
}

bool is_main_thread() {
  static const auto main_thread =
      py::module_::import("threading").attr("main_thread")().attr("ident").cast<unsigned long>();
  return PyThread_get_thread_ident() == main_thread;
}

}  // namespace

StopOnInterrupt::StopOnInterrupt(std::atomic<bool>& stop) {
  std::atomic<bool>* nobodys = nullptr;
  ours_ = is_main_thread() && stopped_by_interrupt.compare_exchange_strong(nobodys, &stop);
  if (!ours_) return;
  interrupted = false;
  struct sigaction action = {};
  action.sa_handler = on_interrupt;
  ::sigaction(SIGINT, &action, &before_);
}

StopOnInterrupt::~StopOnInterrupt() {
  if (!ours_) return;
  ::sigaction(SIGINT, &before_, nullptr);
  stopped_by_interrupt = nullptr;
}

void StopOnInterrupt::raise_if_interrupted() const {
  if (!ours_ || !interrupted) return;
  PyErr_SetNone(PyExc_KeyboardInterrupt);
  throw py::error_already_set();
}

PythonProgress::PythonProgress(py::object report)
    : report_(std::move(report)),
      progress_(
          report_.is_none() ? Progress::Report() : Progress::Report([this](const std::string& task, double fraction) {
            const py::gil_scoped_acquire lock;
            try {
              report_(task, fraction);
            } catch (...) {
              raised_ = std::current_exception();
              stop_ = true;
            }
          }),
          &stop_) {}

void PythonProgress::rethrow() const {
  if (raised_) std::rethrow_exception(raised_);
}

}  // namespace robomill::python
