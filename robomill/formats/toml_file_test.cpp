#include "robomill/formats/toml_file.hpp"
