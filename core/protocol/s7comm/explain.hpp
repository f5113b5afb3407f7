#pragma once

#include "core/base/bytes.hpp"
#include "core/protocol/field_writer.hpp"
#include "core/protocol/s7comm/memory.hpp"

namespace fieldcast::s7comm {

// Offsets begin with the message.
void explain(ByteView message, const Memory& memory, FieldWriter& writer);

}  // namespace fieldcast::s7comm
