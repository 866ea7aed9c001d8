#pragma once
#include <pybind11/pybind11.h>

namespace robomill::python {

/// verbs(): their records, as dictionaries; run(): one of them.
void bind_verbs(pybind11::module_& root);

}  // namespace robomill::python
