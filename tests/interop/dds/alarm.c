/* An operator's panel in C on Cyclone DDS: waits for an unacknowledged alarm, acknowledges it, and
 * prints the result and the new state of the alarm.
 *
 * usage: cyclone-alarm DOMAIN BUS DEVICE CHANNEL NAME NOTE
 *   result STATE CAUSE REASON
 *   alarm PRIORITY STAGE ACTIVE VALUE BY NOTE
 * Exit code 0 only if the alarm has NAME as its acknowledging user. */
#include <inttypes.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "station.h"

enum { kWaitSeconds = 20 };

/* The newest status of the channel's alarm, if one was received. */
static bool take_status(dds_entity_t reader, char** names, fieldcast_AlarmStatus* out) {
  bool came = false;
  void* samples[1] = {NULL};
  dds_sample_info_t info;
  while (dds_take(reader, samples, &info, 1, 1) == 1) {
    const fieldcast_AlarmStatus* status = samples[0];
    if (info.valid_data && strcmp(status->bus, names[0]) == 0 &&
        strcmp(status->device, names[1]) == 0 && strcmp(status->channel, names[2]) == 0) {
      *out = *status;
      came = true;
    }
    dds_return_loan(reader, samples, 1);
  }
  return came;
}

static bool take_result(dds_entity_t reader, const fieldcast_AlarmAction* action) {
  bool came = false;
  void* samples[1] = {NULL};
  dds_sample_info_t info;
  while (dds_take(reader, samples, &info, 1, 1) == 1) {
    const fieldcast_CommandResult* r = samples[0];
    if (info.valid_data && r->request_id == action->request_id &&
        strcmp(r->requester, action->requester) == 0) {
      printf("result\t%s\t%s\t%s\n", state_name(r->state), r->cause, r->reason);
      came = true;
    }
    dds_return_loan(reader, samples, 1);
  }
  return came;
}

static bool is_acknowledged(const fieldcast_AlarmStatus* status) {
  return status->stage == fieldcast_STAGE_ACKNOWLEDGED;
}

static bool is_waiting(const fieldcast_AlarmStatus* status) {
  return status->stage == fieldcast_STAGE_UNACKNOWLEDGED;
}

static bool becomes(dds_entity_t reader, char** names, fieldcast_AlarmStatus* status,
                    bool (*wanted)(const fieldcast_AlarmStatus*), dds_time_t until) {
  for (; dds_time() < until && !stopped(); dds_sleepfor(DDS_MSECS(5))) {
    if (take_status(reader, names, status) && wanted(status)) return true;
  }
  fprintf(stderr, "the alarm did not become so within %d s\n", kWaitSeconds);
  return false;
}

int main(int argc, char** argv) {
  if (argc < 7) {
    fprintf(stderr, "usage: cyclone-alarm DOMAIN BUS DEVICE CHANNEL NAME NOTE\n");
    return 2;
  }
  const dds_entity_t participant = participant_in(argv[1]);
  dds_qos_t* qos = state_qos(0);
  const dds_entity_t alarms =
      reader_of(participant, &fieldcast_AlarmStatus_desc, "fieldcast/AlarmStatus", qos);
  dds_delete_qos(qos);
  qos = request_qos();
  const dds_entity_t results =
      reader_of(participant, &fieldcast_CommandResult_desc, "fieldcast/CommandResult", qos);
  dds_qset_lifespan(qos, DDS_SECS(5));
  dds_qset_writer_data_lifecycle(qos, false);
  const dds_entity_t actions =
      writer_of(participant, &fieldcast_AlarmAction_desc, "fieldcast/AlarmAction", qos);
  dds_delete_qos(qos);

  const dds_time_t until = dds_time() + DDS_SECS(kWaitSeconds);
  static fieldcast_AlarmStatus status;
  if (!matched(actions, results, until) || !becomes(alarms, argv + 2, &status, is_waiting, until))
    return 3;
  static fieldcast_AlarmAction action; /* zeroed */
  snprintf(action.requester, sizeof action.requester, "cyclone:%d:%" PRId64, (int)getpid(),
           dds_time());
  action.request_id = 1;
  action.kind = fieldcast_ACTION_ACKNOWLEDGE;
  snprintf(action.bus, sizeof action.bus, "%s", argv[2]);
  snprintf(action.device, sizeof action.device, "%s", argv[3]);
  snprintf(action.channel, sizeof action.channel, "%s", argv[4]);
  action.limit = status.limit;
  snprintf(action.by, sizeof action.by, "%s", argv[5]);
  snprintf(action.note, sizeof action.note, "%s", argv[6]);
  action.raised_at = status.raised_at;
  need(dds_write(actions, &action), "write");
  bool answered = false;
  for (; dds_time() < until && !answered && !stopped(); dds_sleepfor(DDS_MSECS(2)))
    answered = take_result(results, &action);
  dds_unregister_instance(actions, &action);
  if (!answered || !becomes(alarms, argv + 2, &status, is_acknowledged, until)) return 3;
  printf("alarm\t%d\t%d\t%d\t%g\t%s\t%s\n", (int)status.priority, (int)status.stage, status.active,
         status.value, status.acknowledged.by, status.acknowledged.note);
  dds_delete(participant);
  return strcmp(status.acknowledged.by, argv[5]) == 0 ? 0 : 1;
}
