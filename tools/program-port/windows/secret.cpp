#include "bridge/process/secret.hpp"

#include <aclapi.h>
#include <fmt/format.h>
#include <windows.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <memory>
#include <new>
#include <system_error>

namespace fieldcast {
namespace {

struct CloseHandles {
  void operator()(void* handle) const { ::CloseHandle(handle); }
};
using File = std::unique_ptr<void, CloseHandles>;

tl::unexpected<std::string> fault(const std::string& path, std::string_view what) {
  return tl::unexpected(fmt::format("{}: {}", path, what));
}

std::string text_of(DWORD error) { return std::system_category().message(static_cast<int>(error)); }

// The groups that contain users other than the owner of a file and the administrators.
constexpr std::array kGroupsOfOthers{WinWorldSid,        WinAuthenticatedUserSid,
                                     WinBuiltinUsersSid, WinBuiltinGuestsSid,
                                     WinInteractiveSid,  WinAnonymousSid};
constexpr DWORD kContent = FILE_READ_DATA | FILE_WRITE_DATA | FILE_APPEND_DATA | GENERIC_READ |
                           GENERIC_WRITE | GENERIC_ALL;

bool lets_others_in(const ACL* list) {
  if (list == nullptr) return true;  // no list: all users have all rights
  for (DWORD index = 0; index < list->AceCount; ++index) {
    void* entry = nullptr;
    if (!::GetAce(const_cast<ACL*>(list), index, &entry)) return true;
    auto* allowed = static_cast<ACCESS_ALLOWED_ACE*>(entry);
    if (allowed->Header.AceType != ACCESS_ALLOWED_ACE_TYPE ||
        (allowed->Header.AceFlags & INHERIT_ONLY_ACE) != 0 || (allowed->Mask & kContent) == 0)
      continue;
    PSID who = &allowed->SidStart;
    if (std::ranges::any_of(kGroupsOfOthers,
                            [&](auto group) { return ::IsWellKnownSid(who, group) != 0; }))
      return true;
  }
  return false;
}

tl::expected<File, std::string> opened(const std::string& path) {
  const HANDLE handle = ::CreateFileA(path.c_str(), GENERIC_READ | READ_CONTROL, FILE_SHARE_READ,
                                      nullptr, OPEN_EXISTING, FILE_ATTRIBUTE_NORMAL, nullptr);
  if (handle == INVALID_HANDLE_VALUE)
    return fault(path, fmt::format("cannot be read: {}", text_of(::GetLastError())));
  File file(handle);
  if (::GetFileType(handle) != FILE_TYPE_DISK) return fault(path, "this is no file");
  ACL* list = nullptr;
  PSECURITY_DESCRIPTOR rights = nullptr;
  const DWORD failed = ::GetSecurityInfo(handle, SE_FILE_OBJECT, DACL_SECURITY_INFORMATION, nullptr,
                                         nullptr, &list, nullptr, &rights);
  if (failed != ERROR_SUCCESS)
    return fault(path, fmt::format("its access rights cannot be read: {}", text_of(failed)));
  const bool open = lets_others_in(list);
  ::LocalFree(rights);
  if (open)
    return fault(path, fmt::format("others may read or change it; in a command prompt: icacls "
                                   "\"{}\" /inheritance:r /grant:r \"%USERNAME%:F\"",
                                   path));
  return file;
}

}  // namespace

// On pages of its own, which are not swapped while the process runs, if the system allows that.
Secret::Secret(std::string_view text) : size_(text.size()) {
  if (text.empty()) return;
  void* memory = ::VirtualAlloc(nullptr, text.size(), MEM_COMMIT | MEM_RESERVE, PAGE_READWRITE);
  if (memory == nullptr) throw std::bad_alloc();
  ::VirtualLock(memory, text.size());
  std::memcpy(memory, text.data(), text.size());
  text_ = {static_cast<char*>(memory), [size = size_](const char* old) {
             auto* bytes = const_cast<char*>(old);
             ::SecureZeroMemory(bytes, size);
             ::VirtualFree(bytes, 0, MEM_RELEASE);
           }};
}

Secret Secret::taken_from(std::string& text) {
  Secret secret(text);
  wipe(text);
  return secret;
}

void wipe(std::string& text) {
  text.resize(text.capacity());
  ::SecureZeroMemory(text.data(), text.size());
  text.clear();
}

// Windows has no group of a file: both kinds of readers are the owner and the administrators.
tl::expected<void, std::string> check_secret_file(const std::string& path, Readers) {
  return opened(path).map([](const File&) {});
}

tl::expected<Secret, std::string> read_secret_file(const std::string& path, Readers) {
  const auto file = opened(path);
  if (!file) return tl::unexpected(file.error());
  std::string text(kMaxSecretFile + 1, '\0');
  DWORD size = 0;
  const bool read =
      ::ReadFile(file->get(), text.data(), static_cast<DWORD>(text.size()), &size, nullptr) != 0;
  const DWORD error = ::GetLastError();
  Secret secret(std::string_view(text).substr(0, read ? size : 0));
  wipe(text);
  if (!read) return fault(path, fmt::format("cannot be read: {}", text_of(error)));
  if (size > kMaxSecretFile) return fault(path, "it is too long for a secret");
  return secret;
}

}  // namespace fieldcast
