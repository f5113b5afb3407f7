// C-mode: two-letter commands, words as four digits, long data in several frames.
//
//     read     @ uu Rx first(4) count(4) FCS * CR
//     response @ uu Rx ee data FCS [*] CR           then, after each delimiter: data FCS [*] CR
//
//     write    @ uu Wx first(4) data FCS [*] CR     then, after each delimiter: data FCS [*] CR
//     response @ uu Wx ee FCS * CR
//
// Addresses and counts are decimal, data hexadecimal; EM puts the two digits of the bank before the
// address. The PLC responds to an unknown header with @ uu IC FCS * CR.
#pragma once

#include <memory>
#include <optional>

#include "core/protocol/omron_hostlink/areas.hpp"
#include "core/protocol/protocol.hpp"

namespace fieldcast::omron {

[[nodiscard]] std::optional<ExchangeSize> c_mode_size(const Request& request);
// REQUIRES: c_mode_size(request) holds a value.
[[nodiscard]] std::unique_ptr<Exchange> begin_c_mode(std::uint16_t unit, const Request& request);

// A response shows its unit, its command and, for a read, the amount of data.
[[nodiscard]] bool c_mode_mistakable(const Request& earlier, const Request& later);

}  // namespace fieldcast::omron
