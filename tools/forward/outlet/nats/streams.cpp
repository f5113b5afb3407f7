#include "tools/forward/outlet/nats/streams.hpp"

#include <fmt/format.h>

#include <vector>

namespace fieldcast::forward {

namespace {

using Done = tl::expected<void, std::string>;

Done failure(const std::string& stream, natsStatus status, const char* detail) {
  return tl::make_unexpected(fmt::format("stream {} cannot be created: {}{}", stream,
                                         natsStatus_GetText(status),
                                         detail == nullptr ? "" : fmt::format(" ({})", detail)));
}

Done create_stream(jsCtx& context, const std::string& name, std::vector<const char*> subjects,
                   const StreamSpec& spec) {
  jsStreamConfig config;
  jsStreamConfig_Init(&config);
  config.Name = name.c_str();
  config.Subjects = subjects.data();
  config.SubjectsLen = static_cast<int>(subjects.size());
  config.Storage = js_FileStorage;
  config.Replicas = spec.replicas;
  config.MaxAge = spec.keep.count();
  config.Duplicates = spec.duplicates.count();
  if (spec.keep != Duration{} && spec.keep < spec.duplicates) config.Duplicates = config.MaxAge;
  jsErrCode code{};
  const natsStatus status = js_AddStream(nullptr, &context, &config, nullptr, &code);
  // It exists with other settings.
  if (status == NATS_OK || code == JSStreamNameExistErr) return {};
  return failure(name, status, nats_GetLastError(nullptr));
}

Done create_bucket(jsCtx& context, const std::string& name, const JetStreamSpec& spec) {
  kvStore* bucket = nullptr;
  if (js_KeyValue(&bucket, &context, name.c_str()) != NATS_OK) {
    kvConfig config;
    kvConfig_Init(&config);
    config.Bucket = name.c_str();
    config.History = 1;
    config.StorageType = js_FileStorage;
    config.Replicas = static_cast<int>(spec.streams.replicas);
    if (const natsStatus status = js_CreateKeyValue(&bucket, &context, &config); status != NATS_OK)
      return failure("KV_" + name, status, nats_GetLastError(nullptr));
  }
  kvStore_Destroy(bucket);
  return {};
}

}  // namespace

Done create_streams(jsCtx& context, const JetStreamSpec& spec) {
  if (auto done = create_stream(context, spec.sample_stream, {"fieldcast.>", "fieldcast-late.>"},
                                spec.streams);
      !done)
    return done;
  if (auto done = create_stream(context, spec.alarm_stream, {"fieldcast-alarm.>"}, spec.streams);
      !done)
    return done;
  if (auto done = create_stream(context, spec.audit_stream, {"fieldcast-audit.>"}, spec.streams);
      !done)
    return done;
  if (auto done = create_bucket(context, spec.bucket, spec); !done) return done;
  return create_bucket(context, spec.site_bucket, spec);
}

}  // namespace fieldcast::forward
