#pragma once

#include "core/base/bytes.hpp"
#include "core/protocol/field_writer.hpp"

namespace fieldcast::omron {

// Explains a FINS message, from ICF on. `request`: what its carrier says of its direction.
void explain_fins(ByteView message, bool request, FieldWriter& out);

}  // namespace fieldcast::omron
