#include "eval/peers/gnss_comm_messages.h"

#include "eval/rosbag/ros_header.h"

namespace alidade {
namespace {

template <typename Message>
Result<std::shared_ptr<Message>> Whole(const ByteReader& in, std::shared_ptr<Message> message) {
  if (!in.ok()) {
    return Status::Input("a message of gnss_comm is torn");
  }
  return message;
}

template <typename... Values>
void ReadAll(ByteReader* in, Values*... values) {
  ((*values = in->Read<Values>()), ...);
}

void ReadTime(ByteReader* in, gnss_comm::GnssTimeMsg* time) {
  ReadAll(in, &time->week, &time->tow);
}

void ReadObservation(ByteReader* in, gnss_comm::GnssObsMsg* m) {
  ReadTime(in, &m->time);
  ReadAll(in, &m->sat);
  m->freqs = in->Array<double>();
  m->CN0 = in->Array<double>();
  m->LLI = in->Array<std::uint8_t>();
  m->code = in->Array<std::uint8_t>();
  for (std::vector<double>* values : {&m->psr, &m->psr_std, &m->cp, &m->cp_std, &m->dopp, &m->dopp_std}) {
    *values = in->Array<double>();
  }
  m->status = in->Array<std::uint8_t>();
}

}  // namespace

Result<std::shared_ptr<gnss_comm::GnssMeasMsg>> ReadMeasMsg(std::string_view bytes) {
  ByteReader in(bytes);
  const auto message = std::make_shared<gnss_comm::GnssMeasMsg>();
  const auto count = in.Read<std::uint32_t>();
  for (std::uint32_t i = 0; i < count && in.ok(); ++i) {
    ReadObservation(&in, &message->meas.emplace_back());
  }
  return Whole(in, message);
}

Result<std::shared_ptr<gnss_comm::GnssEphemMsg>> ReadEphemMsg(std::string_view bytes) {
  ByteReader in(bytes);
  const auto m = std::make_shared<gnss_comm::GnssEphemMsg>();
  ReadAll(&in, &m->sat);
  for (gnss_comm::GnssTimeMsg* time : {&m->ttr, &m->toe, &m->toc}) {
    ReadTime(&in, time);
  }
  ReadAll(&in, &m->toe_tow, &m->week, &m->iode, &m->iodc, &m->health, &m->code);
  ReadAll(&in, &m->ura, &m->A, &m->e, &m->i0, &m->omg, &m->OMG0, &m->M0, &m->delta_n, &m->OMG_dot, &m->i_dot);
  ReadAll(&in, &m->cuc, &m->cus, &m->crc, &m->crs, &m->cic, &m->cis);
  ReadAll(&in, &m->af0, &m->af1, &m->af2, &m->tgd0, &m->tgd1, &m->A_dot, &m->n_dot);
  return Whole(in, m);
}

Result<std::shared_ptr<gnss_comm::GnssGloEphemMsg>> ReadGloEphemMsg(std::string_view bytes) {
  ByteReader in(bytes);
  const auto m = std::make_shared<gnss_comm::GnssGloEphemMsg>();
  ReadAll(&in, &m->sat);
  ReadTime(&in, &m->ttr);
  ReadTime(&in, &m->toe);
  ReadAll(&in, &m->freqo, &m->iode, &m->health, &m->age, &m->ura);
  ReadAll(&in, &m->pos_x, &m->pos_y, &m->pos_z, &m->vel_x, &m->vel_y, &m->vel_z);
  ReadAll(&in, &m->acc_x, &m->acc_y, &m->acc_z, &m->tau_n, &m->gamma, &m->delta_tau_n);
  return Whole(in, m);
}

Result<std::shared_ptr<gnss_comm::StampedFloat64Array>> ReadFloat64ArrayMsg(std::string_view bytes) {
  ByteReader in(bytes);
  const auto message = std::make_shared<gnss_comm::StampedFloat64Array>();
  message->header.stamp = ros::Time(SecondsBetween(0, TakeRosHeader(&in)));
  message->data = in.Array<double>();
  return Whole(in, message);
}

}  // namespace alidade
