/* A plant system in C on Cyclone DDS under load: writes many commands, takes their results, and
 * counts the instances that remain.
 *
 * usage: cyclone-results DOMAIN BUS DEVICE CHANNEL COUNT [at-once]
 *   results TAKEN left INSTANCES
 * Every value is out of the channel's range, so the commands are refused without the wire.
 * Exit code 0 if each has its result and no instance remains, 3 after 20 s each. With at-once, the
 * remaining instances are counted immediately and are not a fault. */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "station.h"

enum { kWaitSeconds = 20, kInFlight = 64, kOutOfRange = 30000 };

static dds_instance_handle_t* seen; /* of each result */
static uint64_t taken = 0;

static void take_results(dds_entity_t reader, const char* requester, uint64_t limit) {
  void* samples[1] = {NULL};
  dds_sample_info_t info;
  while (dds_take(reader, samples, &info, 1, 1) == 1) {
    const fieldcast_CommandResult* r = samples[0];
    if (info.valid_data && strcmp(r->requester, requester) == 0 && taken < limit)
      seen[taken++] = info.instance_handle;
    dds_return_loan(reader, samples, 1);
  }
}

/* Returns the number of result instances that the reader still has. */
static uint64_t instances_left(dds_entity_t reader) {
  uint64_t left = 0;
  for (uint64_t i = 0; i < taken; ++i) {
    void* samples[1] = {NULL};
    dds_sample_info_t info;
    const dds_return_t read = dds_read_instance(reader, samples, &info, 1, 1, seen[i]);
    if (read > 0) dds_return_loan(reader, samples, read);
    left += read != DDS_RETCODE_PRECONDITION_NOT_MET;
  }
  return left;
}

int main(int argc, char** argv) {
  if (argc < 6) {
    fprintf(stderr, "usage: cyclone-results DOMAIN BUS DEVICE CHANNEL COUNT [at-once]\n");
    return 2;
  }
  const bool at_once = argc > 6 && strcmp(argv[6], "at-once") == 0;
  const uint64_t count = strtoull(argv[5], NULL, 10);
  seen = calloc(count, sizeof *seen);
  const dds_entity_t participant = participant_in(argv[1]);
  dds_qos_t* qos = request_qos();
  const dds_entity_t results =
      reader_of(participant, &fieldcast_CommandResult_desc, "fieldcast/CommandResult", qos);
  dds_qset_lifespan(qos, DDS_SECS(5));
  dds_qset_writer_data_lifecycle(qos, false);
  const dds_entity_t commands =
      writer_of(participant, &fieldcast_Command_desc, "fieldcast/Command", qos);
  dds_delete_qos(qos);
  if (!matched(commands, results, dds_time() + DDS_SECS(kWaitSeconds))) {
    fprintf(stderr, "no bridge within %d s\n", kWaitSeconds);
    return 3;
  }

  fieldcast_Value value = {._d = fieldcast_VALUE_INT64, ._u.int64_value = kOutOfRange};
  static fieldcast_Command command; /* zeroed */
  set_write(&command, argv + 2, &value);

  dds_time_t until = dds_time() + DDS_SECS(kWaitSeconds);
  while (taken < count && dds_time() < until && !stopped()) {
    if (command.request_id < count && command.request_id < taken + kInFlight) {
      ++command.request_id;
      need(dds_write(commands, &command), "write");
      dds_unregister_instance(commands, &command);
    } else {
      dds_sleepfor(DDS_MSECS(1));
    }
    take_results(results, command.requester, count);
  }
  until = dds_time() + DDS_SECS(kWaitSeconds);
  while (!at_once && instances_left(results) > 0 && dds_time() < until && !stopped()) {
    dds_sleepfor(DDS_MSECS(10));
    take_results(results, command.requester, count);
  }
  const uint64_t left = instances_left(results);
  printf("results\t%" PRIu64 "\tleft\t%" PRIu64 "\n", taken, left);
  dds_delete(participant);
  free(seen);
  return taken == count && (at_once || left == 0) ? 0 : 3;
}
