#pragma once
#include <matio.h>

#include <cstddef>

namespace robomill::io {

/// [bytes] of a value; 0: it is no number.
[[nodiscard]] inline std::size_t mat_number_bytes(matio_classes type) {
  switch (type) {
    case MAT_C_DOUBLE:
    case MAT_C_INT64:
    case MAT_C_UINT64:
      return 8;
    case MAT_C_SINGLE:
    case MAT_C_INT32:
    case MAT_C_UINT32:
      return 4;
    case MAT_C_INT16:
    case MAT_C_UINT16:
      return 2;
    case MAT_C_INT8:
    case MAT_C_UINT8:
      return 1;
    default:
      return 0;
  }
}

}  // namespace robomill::io
