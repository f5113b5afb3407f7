// Fuzzes identity files: the owner of a member's directory, its governance, the name in a
// certificate, the secrets of modules. A fault must be one line, without a word of a secret file.
//
// Input: kind(1), then the text.
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdlib>
#include <string>

#include "bridge/program/module/module_gate.hpp"
#include "bridge/security/member_folder.hpp"
#include "bridge/security/subject.hpp"
#include "core/base/bytes.hpp"
#include "tests/fuzz/fuzz.hpp"

namespace fieldcast {
namespace {

using fuzz::is_one_line;
using fuzz::require;

void read_member_text(const std::string& text) {
  const auto member = security::member_from(text);
  if (!member) return require(is_one_line(member.error()));
  const auto again = security::member_from(security::member_text(*member));
  require(again && again->name == member->name && again->role == member->role &&
          again->buses == member->buses);
}

void read_subject(const std::string& text) {
  const auto subject = security::subject_from(text);
  if (!subject) return;
  require(!subject->name.empty() && !security::der_of(*subject).empty());
}

// A file that only the owner can read, as the reader requires.
class PrivateFile {
 public:
  PrivateFile() : fd_(::memfd_create("secrets", MFD_CLOEXEC)) {
    require(fd_ >= 0 && ::fchmod(fd_, 0600) == 0);
    path_ = "/proc/self/fd/" + std::to_string(fd_);
  }
  const std::string& with(const std::string& text) {
    require(::ftruncate(fd_, 0) == 0 &&
            ::pwrite(fd_, text.data(), text.size(), 0) == static_cast<ssize_t>(text.size()));
    return path_;
  }

 private:
  int fd_;
  std::string path_;
};

void read_module_secrets(const std::string& text) {
  static PrivateFile file;
  const auto secrets = program::ModuleSecrets::read(file.with(text));
  if (!secrets) return require(is_one_line(secrets.error()));
  require(!secrets->fits("12", "challenge", "answer"));
}

void run_one(ByteView data) {
  if (data.empty()) return;
  const std::string text(data.begin() + 1, data.end());
  switch (data[0] % 4) {
    case 0: return read_member_text(text);
    case 1: return (void)security::protects_messages(text);
    case 2: return read_subject(text);
    default: return read_module_secrets(text);
  }
}

}  // namespace
}  // namespace fieldcast

FIELDCAST_FUZZ_TARGET(fieldcast::run_one)
