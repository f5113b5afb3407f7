#include "bridge/process/secret.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sodium.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <new>
#include <string_view>

#include "bridge/base/check.hpp"
#include "bridge/base/file_descriptor.hpp"

namespace fieldcast {

namespace {

void start_sodium() {
  static const int started = sodium_init();  // may be called repeatedly, from any thread
  FIELDCAST_CHECK(started >= 0);
}

tl::unexpected<std::string> fault(const std::string& path, std::string_view what) {
  return tl::unexpected(fmt::format("{}: {}", path, what));
}

tl::expected<FileDescriptor, std::string> opened(const std::string& path, Readers readers) {
  FileDescriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOCTTY));
  if (!file.valid()) return fault(path, fmt::format("cannot be read: {}", errno_text(errno)));
  struct stat found {};
  if (::fstat(file.get(), &found) != 0) return fault(path, errno_text(errno));
  if (!S_ISREG(found.st_mode) && !S_ISFIFO(found.st_mode)) return fault(path, "this is no file");
  const mode_t others = readers == Readers::kOwner ? S_IRWXG | S_IRWXO : S_IWGRP | S_IRWXO;
  if ((found.st_mode & others) != 0)
    return fault(path, fmt::format("others may read or change it; chmod 600 {}", path));
  const uid_t self = ::geteuid();
  if (self != 0 && found.st_uid != self && found.st_uid != 0)
    return fault(path, "it belongs to another user, who can read and change it");
  return file;
}

// The leak check of a sanitizer traces its own process, which needs PR_SET_DUMPABLE.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool kTraced = true;
#else
constexpr bool kTraced = false;
#endif

bool dumps_are_wanted() {
  const char* wanted = std::getenv("FIELDCAST_CORE_DUMPS");
  return wanted != nullptr && std::string_view(wanted) == "1";
}

}  // namespace

Secret::Secret(std::string_view text) : size_(text.size()) {
  if (text.empty()) return;
  start_sodium();
  auto* memory = static_cast<char*>(sodium_malloc(text.size()));
  if (memory == nullptr) throw std::bad_alloc();
  std::memcpy(memory, text.data(), text.size());
  sodium_mprotect_readonly(memory);
  text_ = {memory, [](const char* old) { sodium_free(const_cast<char*>(old)); }};
}

Secret Secret::taken_from(std::string& text) {
  Secret secret(text);
  wipe(text);
  return secret;
}

bool same_bytes(std::string_view a, std::string_view b) {
  start_sodium();
  return a.size() == b.size() && sodium_memcmp(a.data(), b.data(), a.size()) == 0;
}

void wipe(std::string& text) {
  // Also overwrites what a longer text has left behind the end.
  text.resize(text.capacity());
  sodium_memzero(text.data(), text.size());
  text.clear();
}

bool secrets_are_locked() {
  start_sodium();
  static const bool locked = [] {
    constexpr std::size_t kTrial = 16 * 4096;  // several secrets, each on its own pages
    void* memory = sodium_malloc(kTrial);
    if (memory == nullptr) return false;
    // sodium_malloc() does not report whether it locked the memory, so this locks it again.
    const bool can = sodium_mlock(memory, kTrial) == 0;
    sodium_free(memory);
    return can;
  }();
  return locked;
}

tl::expected<void, std::string> check_secret_file(const std::string& path, Readers readers) {
  return opened(path, readers).map([](const FileDescriptor&) {});
}

tl::expected<Secret, std::string> read_secret_file(const std::string& path, Readers readers) {
  const auto file = opened(path, readers);
  if (!file) return tl::unexpected(file.error());
  std::string text;
  text.reserve(kMaxSecretFile + 1);  // no reallocation, which would leave a copy behind
  std::array<char, 1024> part;
  ssize_t size = 0;
  while ((size = ::read(file->get(), part.data(), part.size())) > 0 &&
         text.size() <= kMaxSecretFile) {
    text.append(part.data(),
                std::min(static_cast<std::size_t>(size), text.capacity() - text.size()));
  }
  const int error = errno;
  const bool too_long = text.size() > kMaxSecretFile;
  Secret secret = Secret::taken_from(text);
  ::explicit_bzero(part.data(), part.size());
  if (size < 0) return fault(path, fmt::format("cannot be read: {}", errno_text(error)));
  if (too_long) return fault(path, "it is too long for a secret");
  return secret;
}

void guard_memory() {
  if (dumps_are_wanted()) return;
  // The limit does not stop a core dump to a pipe in core_pattern. The flag alone does not stop one
  // to a file if fs.suid_dumpable is set.
  const rlimit none{0, 0};
  (void)::setrlimit(RLIMIT_CORE, &none);
  if (!kTraced) (void)::prctl(PR_SET_DUMPABLE, 0, 0, 0, 0);
}

std::string unguarded_memory() {
  if (!kTraced && ::prctl(PR_GET_DUMPABLE, 0, 0, 0, 0) != 0)
    return "a core dump of this process would hold its secrets (FIELDCAST_CORE_DUMPS=1)";
  if (!secrets_are_locked())
    return "secrets in memory may be written to swap: the limit of locked memory is too small; "
           "LimitMEMLOCK=8M in the service, or ulimit -l";
  return {};
}

}  // namespace fieldcast
