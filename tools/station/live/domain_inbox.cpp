#include "tools/station/live/domain_inbox.hpp"

#include <utility>
#include <variant>

namespace fieldcast::web {
template <typename Change>
void DomainInbox::apply(Change change) {
  {
    const std::lock_guard lock(mutex_);
    if (!change() || std::exchange(woken_, true)) return;
  }
  wake_();
}

DomainInbox::PathNews* DomainInbox::news_of(const PathView& path) {
  if (const auto found = batch_.by_path.find(path); found != batch_.by_path.end())
    return found->second;
  if (batch_.paths.size() >= LiveModel::kMaxChannels) {
    ++counters_.dropped;
    return nullptr;
  }
  PathNews& news = batch_.paths.emplace_back();
  news.path = path.owned();
  batch_.by_path.emplace(PathView{news.path}, &news);
  return &news;
}

void DomainInbox::on_channel(const StationChannel& channel, Origin origin) {
  apply([&] {
    PathNews* const news = news_of({channel.bus, channel.device, channel.channel});
    if (news == nullptr) return false;
    news->channel = std::make_unique<StationChannel>(channel);
    news->origin = origin;
    return true;
  });
}

void DomainInbox::on_sample(const StationSample& sample) {
  on_value({sample.bus, sample.device, sample.channel},
           {sample.value, sample.quality, sample.device_code, sample.acquired_at, sample.sequence});
}

void DomainInbox::on_value(const PathView& path, LiveValue value) {
  apply([&] {
    ++counters_.samples;
    PathNews* const news = news_of(path);
    if (news == nullptr) return false;
    if (std::exchange(news->has_value, true)) ++counters_.overtaken;
    news->value = std::move(value);
    return true;
  });
}

void DomainInbox::on_silent(const std::string& site) {
  apply([&] {
    batch_.silent.insert(site);
    return true;
  });
}

void DomainInbox::on_gone(const std::string& bus, const std::string& device,
                          const std::string& channel) {
  apply([&] {
    PathNews* const news = news_of({bus, device, channel});
    if (news == nullptr) return false;
    news->gone = true;
    news->channel.reset();
    news->has_value = false;
    return true;
  });
}

void DomainInbox::put_news(ObjectNews news) {
  std::string key = key_of(news.object);
  // Detailed alarms have separate keys, so the two kinds do not replace each other.
  const auto* const alarm = std::get_if<LiveAlarm>(&news.object);
  if (alarm != nullptr && alarm->detailed) key += '+';
  apply([&] {
    if (batch_.objects.size() >= kMaxObjects && !batch_.objects.contains(key)) {
      ++counters_.dropped;
      return false;
    }
    batch_.objects.insert_or_assign(std::move(key), std::move(news));
    return true;
  });
}

void DomainInbox::deliver(LiveModel& model, Instant now) {
  Batch batch;
  {
    const std::lock_guard lock(mutex_);
    woken_ = false;
    ++counters_.deliveries;
    std::swap(batch, batch_);
  }
  for (PathNews& news : batch.paths) {
    if (news.gone) model.on_gone(news.path);
    if (news.channel) model.on_channel(*news.channel, news.origin);
    if (news.has_value) model.on_sample(news.path, std::move(news.value), now);
  }
  for (const std::string& site : batch.silent) model.on_silent(site);
  for (auto& [key, news] : batch.objects)
    news.gone ? model.remove(news.object) : model.put(std::move(news.object));
}

DomainInbox::Counters DomainInbox::counters() const {
  const std::lock_guard lock(mutex_);
  return counters_;
}

}  // namespace fieldcast::web
