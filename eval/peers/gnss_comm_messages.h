#pragma once

#include <memory>
#include <string_view>

#include "core/status.h"
#include "eval/peers/stubs/gnss_comm/GnssEphemMsg.h"
#include "eval/peers/stubs/gnss_comm/GnssGloEphemMsg.h"
#include "eval/peers/stubs/gnss_comm/GnssMeasMsg.h"
#include "eval/peers/stubs/gnss_comm/StampedFloat64Array.h"

namespace alidade {

// Messages of gnss_comm from the bytes that a bag holds of them, field by field, for the message code of
// systems that read them. kInput: torn.

Result<std::shared_ptr<gnss_comm::GnssMeasMsg>> ReadMeasMsg(std::string_view bytes);
Result<std::shared_ptr<gnss_comm::GnssEphemMsg>> ReadEphemMsg(std::string_view bytes);
Result<std::shared_ptr<gnss_comm::GnssGloEphemMsg>> ReadGloEphemMsg(std::string_view bytes);
Result<std::shared_ptr<gnss_comm::StampedFloat64Array>> ReadFloat64ArrayMsg(std::string_view bytes);

}  // namespace alidade
