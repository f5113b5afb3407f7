#include "bridge/configure/draft_check.hpp"

#include <algorithm>
#include <filesystem>
#include <functional>

#include "config/files/file_reader.hpp"
#include "core/schedule/bus_plan.hpp"
#include "core/schedule/bus_schedule.hpp"

namespace fieldcast::configure {

namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostWorst = 10, kMostInfeasible = 100;  // channels of a bus

bool is_below(const fs::path& path, const fs::path& folder) {
  const auto [end, rest] = std::mismatch(folder.begin(), folder.end(), path.begin(), path.end());
  return end == folder.end() && rest != path.end();
}

// The folders whose files a draft may name.
std::vector<fs::path> folders_of(const std::string& file, const config::LoadOptions& options) {
  std::error_code failure;
  std::vector<fs::path> folders{fs::weakly_canonical(file, failure).parent_path()};
  for (const auto* all : {&options.template_directories, &options.protocol_directories}) {
    for (const std::string& folder : *all) folders.push_back(fs::weakly_canonical(folder, failure));
  }
  return folders;
}

struct ChannelGap {
  std::string channel;
  Duration refresh{}, gap{};
  [[nodiscard]] double tightness() const { return to_seconds(gap) / to_seconds(refresh); }
};

std::vector<ChannelGap> gaps_of(const BusPlan& plan) {
  std::vector<ChannelGap> rows;
  std::size_t index = 0;
  for (const DeviceSpec& device : plan.bus->devices) {
    for (const ChannelSpec& channel : device.channels) {
      if (const auto point = plan.point_of[index++])
        rows.push_back({plan.bus->name + '/' + device.name + '/' + channel.name, channel.refresh,
                        plan.prediction.points[*point].worst_gap});
    }
  }
  std::ranges::stable_sort(rows, std::ranges::greater{}, &ChannelGap::tightness);
  return rows;
}

Json plan_json(const BusPlan& plan) {
  const std::vector<ChannelGap> gaps = gaps_of(plan);  // the worst first
  Json worst = Json::array();
  for (std::size_t i = 0; i < std::min(gaps.size(), kMostWorst); ++i)
    worst.push_back({{"channel", gaps[i].channel},
                     {"refresh_ms", milliseconds(gaps[i].refresh)},
                     {"gap_ms", milliseconds(gaps[i].gap)}});
  std::vector<std::string> infeasible;
  for (const ChannelGap& row : gaps) {
    if (row.gap > row.refresh && infeasible.size() < kMostInfeasible)
      infeasible.push_back(row.channel);
  }
  const Prediction& prediction = plan.prediction;
  return {{"bus", plan.bus->name},           {"load", prediction.planned_load},
          {"feasible", prediction.feasible}, {"worst", worst},
          {"infeasible", infeasible},        {"remedies", advice(plan)}};
}

using Allowed = std::function<bool(const std::string& path)>;

// Secrets and keys are read to be checked, and are never shown.
bool is_shown(const std::string& path, const std::string& text) {
  return path.ends_with(".csv") ? config::has_columns(text)
                                : config::is_template(text) || config::is_declaration(text);
}

void load(std::string_view text, const std::string& file, const Allowed& allowed,
          config::LoadOptions options, Draft& draft) {
  options.places = &draft.places;
  const config::FileReader disk = config::disk_reader();
  config::FileReader reader;
  reader.read = [&](const std::string& path) -> tl::expected<std::string, config::FileError> {
    if (!allowed(path)) return tl::unexpected(config::FileError::kUnreadable);
    auto read = disk.read(path);
    if (read && draft.paths.insert(path).second && is_shown(path, *read))
      draft.files.push_back({path, *read});
    return read;
  };
  reader.list = [&](const std::string& directory) {
    return allowed((directory.empty() ? "." : directory) + "/x") ? disk.list(directory)
                                                                 : std::vector<std::string>{};
  };
  draft.loaded = config::load_text(text, file, reader, options);
}

}  // namespace

Draft load_present(std::string_view text, const std::string& file) {
  Draft draft;
  load(
      text, file, [](const std::string&) { return true; }, config::default_options(), draft);
  return draft;
}

Draft load_draft(std::string_view text, const std::string& file, const std::set<std::string>& also,
                 Hopeless hopeless) {
  config::LoadOptions options = config::default_options();
  options.refuse_hopeless = hopeless == Hopeless::kRefuse;
  const std::vector<fs::path> folders = folders_of(file, options);
  const auto allowed = [&](const std::string& path) {
    std::error_code failure;
    const fs::path whole = fs::weakly_canonical(path, failure);
    return also.contains(path) || std::ranges::any_of(folders, [&](const fs::path& folder) {
             return is_below(whole, folder);
           });
  };
  Draft draft;
  load(text, file, allowed, options, draft);
  return draft;
}

Json fault_json(const std::string& file, const std::string& message, const std::string& hint) {
  return {{"file", file}, {"line", 1}, {"column", 1}, {"message", message}, {"hint", hint}};
}

Json faults_json(const std::vector<config::Fault>& faults) {
  Json list = Json::array();
  for (const config::Fault& fault : faults) {
    std::string hint = fault.allowed.empty() ? "" : "allowed: " + fault.allowed;
    if (!fault.suggestion.empty())
      hint += (hint.empty() ? "did you mean " : "; did you mean ") + fault.suggestion + "?";
    list.push_back({{"file", fault.file},
                    {"line", fault.line},
                    {"column", fault.column},
                    {"message", fault.what},
                    {"hint", hint}});
  }
  return list;
}

Json plans_json(const BridgeSpec& spec) {
  Json list = Json::array();
  for (const BusSpec& bus : spec.buses)
    list.push_back(plan_json(make_plan(bus, kAssumedResponseTime)));
  return list;
}

}  // namespace fieldcast::configure
