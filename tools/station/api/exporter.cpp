#include "tools/station/api/exporter.hpp"

#include "bridge/store/tiers/tier_history.hpp"
#include "core/base/json.hpp"
#include "tools/cli/view/bucket_view.hpp"
#include "tools/cli/view/record_view.hpp"

namespace fieldcast::web {

Exporter::Exporter(ExportQuestion question) : question_(std::move(question)) {
  if (question_.compress) gzip_.emplace();
}

std::optional<std::string> Exporter::next(SqlConnection& connection) {
  if (ended_) return std::nullopt;
  const auto until = std::chrono::steady_clock::now() + kLongestPiece;
  if (!std::exchange(begun_, true)) begin(connection);
  for (;;) {
    while (channel_ < channels_.size() && text_.size() < kPiece &&
           std::chrono::steady_clock::now() < until) {
      const bool done = question_.every ? add_buckets(connection) : add_samples(connection);
      if (!done) continue;
      ++channel_;
      after_ = {question_.from};
      bucket_ = question_.from;
    }
    ended_ = channel_ == channels_.size();
    std::string piece = take(ended_);
    // zlib buffers short texts; returning an empty piece would cost another query.
    if (!piece.empty() || ended_ || std::chrono::steady_clock::now() >= until) return piece;
  }
}

std::string Exporter::broken_off() {
  ended_ = true;
  const std::string_view broken = "incomplete: the database does not respond";
  text_ += question_.json_lines ? JsonObject().add("error", broken).take() : broken;
  text_ += '\n';
  return take(true);
}

void Exporter::begin(SqlConnection& connection) {
  channels_ = SampleTable(connection).channels(question_.pattern);
  after_ = {question_.from};
  bucket_ = question_.from;
  if (question_.json_lines) return;
  text_ += question_.every ? cli::bucket_csv_head() : cli::history_csv_head();
  text_ += '\n';
}

bool Exporter::add_samples(SqlConnection& connection) {
  const auto count = SampleTable(connection)
                         .part(channels_[channel_], after_, question_.to, kSamplesAtOnce,
                               [this](const StoredSample& sample) {
                                 text_ += question_.json_lines ? cli::record_json(sample).text()
                                                               : cli::history_csv(sample);
                                 text_ += '\n';
                               });
  return count < kSamplesAtOnce;
}

bool Exporter::add_buckets(SqlConnection& connection) {
  const Duration every = *question_.every;
  const StoredChannel& channel = channels_[channel_];
  const std::int64_t span = every.count() * kBucketsAtOnce;
  // The span is a multiple of the bucket length, so that no bucket is split.
  const UtcTime first = bucket_start(bucket_, every);
  const UtcTime end = question_.to.nanoseconds - first.nanoseconds > span
                          ? UtcTime{first.nanoseconds + span}
                          : question_.to;
  TierHistory(connection, every).read(channel, bucket_, end, [&](const Bucket& bucket) {
    text_ += question_.json_lines ? cli::bucket_json(channel, bucket).text()
                                  : cli::bucket_csv(channel, bucket, cli::Zone::kUtc);
    text_ += '\n';
    return true;
  });
  bucket_ = end;
  return end >= question_.to;
}

std::string Exporter::take(bool last) {
  std::string text = std::exchange(text_, {});
  if (!gzip_) return text;
  text = gzip_->put(text);
  return last ? text + gzip_->finish() : text;
}

}  // namespace fieldcast::web
