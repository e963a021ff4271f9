#include "lobe_order.h"

namespace lumel::baker {

void orderLobes(std::vector<Level>&)
{
}

} // namespace lumel::baker
