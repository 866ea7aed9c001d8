#include "robomill/robot/arm.hpp"
