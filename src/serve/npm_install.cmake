# Installs the pinned packages of web/ unless they are there. Several build folders may do so at once.
# Usage: cmake -DNPM=... -DWEB=... -P npm_install.cmake
set(lock ${WEB}/package-lock.json)
set(installed ${WEB}/node_modules/.package-lock.json)
file(LOCK ${WEB} DIRECTORY GUARD PROCESS TIMEOUT 600)
if(NOT EXISTS ${installed} OR ${lock} IS_NEWER_THAN ${installed})
  execute_process(COMMAND ${NPM} ci --no-fund --no-audit WORKING_DIRECTORY ${WEB} RESULT_VARIABLE failed)
  if(failed)
    message(FATAL_ERROR "npm ci failed in ${WEB}; without a network configure with -DCLIPGS_WEB=OFF")
  endif()
  file(TOUCH ${installed})
endif()
