// Describes who may use the programming port according to the configuration, in human-readable text
// for the start and --check. Values only; any thread.
#pragma once

#include <optional>
#include <string>

#include "core/model/program_spec.hpp"

namespace fieldcast::program {

// "modules dial in at 0.0.0.0:4951: TLS with a certificate of plant.pem, from 10.0.0.0/8; a second
// one of a number is refused"
[[nodiscard]] std::string to_text(const ModulesSpec& modules);
// "engineers connect at 0.0.0.0:4950: TLS, a login with the password of a user"
[[nodiscard]] std::string to_text(const EngineersSpec& engineers);

// The first configured file that cannot be used.
struct AccessFault {
  std::string key;  // of `program:` in the configuration: "modules.secrets"
  std::string text;
};
[[nodiscard]] std::optional<AccessFault> check_files(const ProgramSpec& program);

}  // namespace fieldcast::program
