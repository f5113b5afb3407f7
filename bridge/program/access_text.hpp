// What the configuration of the programming port says about who may enter, for people: said at the
// start and by --check. Values only; any thread.
#pragma once

#include <string>
#include <tl/expected.hpp>

#include "core/model/spec.hpp"

namespace fieldcast::program {

// "modules dial in at 0.0.0.0:4951: TLS with a certificate of plant.pem, from 10.0.0.0/8; a second
// one of a number is refused"
[[nodiscard]] std::string to_text(const ModulesSpec& modules);
// "engineers connect at 0.0.0.0:4950: TLS, a login with the password of a user"
[[nodiscard]] std::string to_text(const EngineersSpec& engineers);

// Whether every file that is named can be used; the error is one line.
[[nodiscard]] tl::expected<void, std::string> check_files(const ProgramSpec& program);

}  // namespace fieldcast::program
