// Converts the messages of a standby group to DDS and back. Pure functions; any thread. Texts are
// cut at their bounds.
#pragma once

#include <optional>

#include "bridge/standby/standby_values.hpp"
#include "idl/topics.h"

namespace fieldcast {

namespace idl = ::fieldcast_idl;

void to_idl(const StandbyMessage& message, idl::Standby& out);
// Returns `std::nullopt` for an unknown role.
[[nodiscard]] std::optional<StandbyMessage> from_idl(const idl::Standby& message);

void to_idl(const StandbyNote& note, idl::StandbyNote& out);
[[nodiscard]] StandbyNote from_idl(const idl::StandbyNote& note);

void to_idl(const StandbyRequest& request, idl::StandbyRequest& out);
[[nodiscard]] StandbyRequest from_idl(const idl::StandbyRequest& request);

}  // namespace fieldcast
