#include "tools/station/api/export.hpp"

#include <algorithm>

#include "bridge/store/tiers/tier_table.hpp"
#include "core/base/json.hpp"
#include "tools/cli/view/record_view.hpp"
#include "tools/station/api/api_routes.hpp"
#include "tools/station/api/base/exchange.hpp"
#include "tools/station/api/history.hpp"

namespace fieldcast::web {

namespace {

constexpr Duration kShortest = std::chrono::milliseconds{1};

class ExportStream {
 public:
  ExportStream(Database& database, ExportQuestion question, RunningExports::Slot slot)
      : database_(database), exporter_(std::move(question)), slot_(std::move(slot)) {}
  ExportStream(const ExportStream&) = delete;
  ExportStream& operator=(const ExportStream&) = delete;

  static void next(const std::shared_ptr<ExportStream>& self, std::function<void(Piece)> give) {
    if (self->broken_) return give(std::nullopt);
    // The query keeps the stream alive if the client disconnects meanwhile.
    self->database_.query_further<Piece>(
        [self](SqlConnection& connection) { return self->exporter_.next(connection); },
        [self, give = std::move(give)](tl::expected<Piece, DatabaseFault> piece) mutable {
          if (!piece) {
            self->broken_ = true;
            return give(self->exporter_.broken_off());
          }
          // An empty piece: no sample was found within kLongestPiece, or zlib buffers the bytes.
          if (*piece && (*piece)->empty()) return next(self, std::move(give));
          give(*std::move(piece));
        });
  }

 private:
  Database& database_;
  Exporter exporter_;
  const RunningExports::Slot slot_;
  bool broken_ = false;  // used on the io thread
};

HttpResponse streamed(Database& database, ExportQuestion question, RunningExports::Slot slot) {
  HttpResponse response;
  response.content_type = question.json_lines ? "application/x-ndjson" : "text/csv; charset=utf-8";
  response.headers.emplace_back("content-disposition",
                                "attachment; filename=\"" + export_file_name(question) + '"');
  if (question.compress) response.headers.emplace_back("content-encoding", "gzip");
  auto stream = std::make_shared<ExportStream>(database, std::move(question), std::move(slot));
  response.next = [stream](std::function<void(Piece)> give) {
    ExportStream::next(stream, std::move(give));
  };
  return response;
}

}  // namespace

RunningExports::Slot RunningExports::begin(const std::string& user) {
  std::erase_if(slots_, [](const auto& slot) { return slot.expired(); });
  const auto is_of_user = [&](const auto& slot) {
    const Slot running = slot.lock();
    return running && *running == user;
  };
  const auto of_user = static_cast<std::size_t>(std::ranges::count_if(slots_, is_of_user));
  if (slots_.size() >= kMax || of_user >= kMaxOfUser) return nullptr;
  const auto slot = std::make_shared<const std::string>(user);
  slots_.push_back(slot);
  return slot;
}

void export_history(const Api& api, const HttpRequest& request, const Caller& caller,
                    const Reply& reply) {
  const Parameters parameters(request, {"pattern", "channel", "from", "to", "format", "every"});
  if (auto fault = parameters.fault("channel")) return reply(*std::move(fault));
  auto channels = request.parameter("channel") ? parameters.channels("channel", kMaxHistoryChannels)
                                               : std::vector<ChannelPath>();
  if (!channels) return reply(std::move(channels.error()));
  auto pattern = parameters.pattern("pattern");
  if (!pattern) return reply(std::move(pattern.error()));
  auto span = parameters.span(api.now(), kOneDay);
  if (!span) return reply(std::move(span.error()));
  auto json_lines = parameters.chosen("format", "csv", "jsonl");
  if (!json_lines) return reply(std::move(json_lines.error()));
  auto every = parameters.duration("every", kShortest);
  if (!every) return reply(std::move(every.error()));
  RunningExports::Slot slot = api.exports->begin(caller.user);
  if (!slot)
    return reply(error_response(503, "too many exports are in progress",
                                "ask again when one of them has ended"));
  reply(streamed(*api.database,
                 {*std::move(channels), *std::move(pattern), span->from, span->to, *every,
                  *json_lines, request.accepts_gzip},
                 std::move(slot)));
}

std::string export_file_name(const ExportQuestion& question) {
  constexpr std::size_t kLongestName = 120;
  const std::string_view end = question.json_lines ? ".jsonl" : ".csv";
  std::string name;
  const ChannelPath* last = nullptr;
  for (const ChannelPath& path : question.channels) {
    const bool same_device =
        last != nullptr && last->bus == path.bus && last->device == path.device;
    if (last != nullptr) name += '+';
    name += same_device ? path.channel : path.bus + '_' + path.device + '_' + path.channel;
    last = &path;
  }
  if (name.empty()) name = "history";
  for (char& c : name) {
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
    if (!plain && c != '-' && c != '+' && c != '.') c = '_';
  }
  if (name.size() > kLongestName) name.resize(kLongestName);
  return name.append(end);
}

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
  SampleTable table(connection);
  if (question_.channels.empty()) channels_ = table.channels(question_.pattern);
  for (const ChannelPath& path : question_.channels) {
    if (auto found = table.find(path)) channels_.push_back(*std::move(found));
  }
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
