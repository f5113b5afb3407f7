#include "bridge/capture/capture_folder.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <sys/statvfs.h>

#include <algorithm>
#include <cerrno>
#include <ctime>
#include <filesystem>

#include "bridge/base/errno_text.hpp"

namespace fieldcast {
namespace {

constexpr std::string_view kEnding = ".pcapng";
constexpr std::string_view kTimeForm = "20261122T142421Z";

std::string time_name(UtcTime at) {
  const std::time_t seconds = at.nanoseconds / 1'000'000'000;
  std::tm parts{};
  ::gmtime_r(&seconds, &parts);
  return fmt::format("{:%Y%m%dT%H%M%SZ}", parts);
}

bool has_time_form(std::string_view text) {
  if (text.size() != kTimeForm.size()) return false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool digit = text[i] >= '0' && text[i] <= '9';
    const bool digit_wanted = kTimeForm[i] >= '0' && kTimeForm[i] <= '9';
    if (digit != digit_wanted || (!digit && text[i] != kTimeForm[i])) return false;
  }
  return true;
}

// The part after the name of the bus: "20261122T142421Z" or "20261122T142421Z-0002".
bool is_ring_name(std::string_view rest) {
  if (!has_time_form(rest.substr(0, kTimeForm.size()))) return false;
  rest.remove_prefix(kTimeForm.size());
  return rest.empty() || (rest.size() == 5 && rest[0] == '-' &&
                          rest.find_first_not_of("0123456789", 1) == rest.npos);
}

}  // namespace

std::string ring_file_name(const std::string& bus, UtcTime begun, int number) {
  const std::string name = fmt::format("{}-{}", bus, time_name(begun));
  return number < 2 ? name + std::string(kEnding)
                    : fmt::format("{}-{:04}{}", name, number, kEnding);
}

std::vector<std::string> ring_files(const std::string& bus, std::vector<std::string> names) {
  std::erase_if(names, [&](const std::string& name) {
    std::string_view rest = name;
    if (!rest.starts_with(bus + "-") || !rest.ends_with(kEnding)) return true;
    rest.remove_prefix(bus.size() + 1);
    rest.remove_suffix(kEnding.size());
    return !is_ring_name(rest);
  });
  // Sorts without the ending, so that a name is before the same name with a number.
  std::ranges::sort(names, {}, [](const std::string& name) {
    return name.substr(0, name.size() - kEnding.size());
  });
  return names;
}

std::vector<std::string> ring_files_in(const std::string& folder, const std::string& bus) {
  std::vector<std::string> names;
  std::error_code error;
  for (std::filesystem::directory_iterator each(folder, error), end; !error && each != end;
       each.increment(error))
    names.push_back(each->path().filename().string());
  return ring_files(bus, std::move(names));
}

tl::expected<std::uint64_t, std::string> free_bytes_at(const std::string& folder) {
  struct statvfs disk {};
  if (::statvfs(folder.c_str(), &disk) != 0)
    return tl::unexpected(folder + ": " + errno_text(errno));
  return static_cast<std::uint64_t>(disk.f_bavail) * disk.f_frsize;
}

}  // namespace fieldcast
