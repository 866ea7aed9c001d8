#include "python/bindings/verbs.hpp"

#include <pybind11/functional.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "python/bindings/call.hpp"
#include "robomill/base/error.hpp"
#include "robomill/base/names.hpp"
#include "robomill/io/json.hpp"
#include "robomill/jobs/outputs.hpp"
#include "robomill/jobs/sweep/chunks.hpp"
#include "robomill/jobs/verbs.hpp"
#include "robomill/page/report.hpp"

namespace robomill::python {
namespace {

py::dict record_of(const jobs::VerbOption& option) {
  py::dict out;
  out["name"] = std::string(option.name);
  out["meaning"] = std::string(option.meaning);
  out["takes"] = std::string(name_in(jobs::takes_names, option.takes));
  out["required"] = option.required;
  out["unit"] = std::string(option.unit);
  out["needs"] = std::string(option.needs);
  out["excludes"] = std::string(option.excludes);
  out["words"] = std::vector<std::string>(option.words.begin(), option.words.end());
  return out;
}

std::vector<jobs::Verb> all_verbs() {
  std::vector<jobs::Verb> out(jobs::verbs().begin(), jobs::verbs().end());
  out.push_back(jobs::learn_verb());
  return out;
}

py::list records() {
  py::list out;
  for (const jobs::Verb& verb : all_verbs()) {
    py::dict one;
    one["name"] = std::string(verb.name);
    one["purpose"] = std::string(verb.purpose);
    one["more"] = std::string(verb.more);
    one["example"] = std::string(verb.example);
    one["input"] = record_of(verb.input);
    one["output"] = std::string(verb.output);
    one["has_report"] = verb.computes;
    py::list options;
    for (const jobs::VerbOption& option : verb.options) options.append(record_of(option));
    one["options"] = options;
    out.append(one);
  }
  return out;
}

/// @param options  JSON: an object
/// @returns the document as JSON, the summary, why the answer was not reached, and a function that makes the page
py::tuple run(const std::string& name, const std::vector<std::filesystem::path>& inputs,
              const std::filesystem::path& output, const std::string& options, const py::object& progress) {
  const std::vector<jobs::Verb> verbs = all_verbs();
  const auto verb = std::ranges::find(verbs, name, &jobs::Verb::name);
  if (verb == verbs.end()) throw InvalidInput("verb", "there is none of this name: " + name);
  const std::filesystem::path first = inputs.empty() ? std::filesystem::path() : inputs.front();
  jobs::VerbJob job{.verb = *verb, .inputs = inputs, .output = output, .wants_json = true, .wants_curves = true};
  job.options = jobs::checked_options(*verb, jobs::AskedBy::request, first, io::Json::parse(options));
  if (verb->document && !output.empty()) jobs::require_output(*verb->document, output);
  jobs::Outcome outcome = with_progress(progress, [&](Progress& to) { return verb->run(job, to); });
  py::object page = py::none();
  if (outcome.page) {
    page = py::cpp_function([make = outcome.page] { return without_lock([&] { return page::report_html(make()); }); });
  }
  return py::make_tuple(outcome.json, outcome.summary, outcome.shortfall, page);
}

/// Chunks of a study, for clusters; their bytes are bytes.
void bind_studies(py::module_& root) {
  using jobs::StudyChunks;
  using jobs::StudyFolder;
  py::class_<StudyChunks>(root, "_StudyChunks")
      .def(py::init([](const std::filesystem::path& study) {
        return without_lock([&] { return std::make_unique<StudyChunks>(study); });
      }))
      .def_property_readonly("fingerprint", &StudyChunks::fingerprint)
      .def("bytes_of", [](const StudyChunks& self, std::uint64_t chunk, std::uint64_t chunk_points) {
        return py::bytes(without_lock([&] { return self.bytes_of(chunk, chunk_points, Progress::none()); }));
      });
  py::class_<StudyFolder>(root, "_StudyFolder")
      .def(py::init([](const std::filesystem::path& study, const std::filesystem::path& folder) {
        return without_lock([&] { return std::make_unique<StudyFolder>(study, folder); });
      }))
      .def_property_readonly("fingerprint", &StudyFolder::fingerprint)
      .def_property_readonly("chunk_points", &StudyFolder::chunk_points)
      .def_property_readonly("todo", &StudyFolder::todo)
      .def("save",
           [](StudyFolder& self, std::uint64_t chunk, const py::bytes& bytes) {
             const std::string content = bytes;
             without_lock([&] { self.save(chunk, content); });
           })
      .def("__enter__", [](py::object self) { return self; })
      .def("__exit__", [](StudyFolder& self, const py::args&) { self.close(); });
}

}  // namespace

void bind_verbs(py::module_& root) {
  bind_studies(root);
  root.def("_verbs", records);
  root.def("_run", run, py::arg("verb"), py::arg("inputs"), py::arg("output"), py::arg("options"),
           py::arg("progress") = py::none());
}

}  // namespace robomill::python
